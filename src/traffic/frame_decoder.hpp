#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "can/frame.hpp"
#include "canopen/emergency_ids.hpp"
#include "canopen/sdo_observer.hpp"
#include "report/json_writer.hpp"
#include "show/desk.hpp"
#include "show/pdo_book.hpp"
#include "traffic/modes_seen.hpp"

namespace servoctl::traffic {

/// What a frame can be, as `--service` names it.
inline constexpr std::string_view kServices[] = {"nmt",      "sync", "time",       "emcy",
                                                 "pdo",      "sdo",  "boot-up",    "heartbeat",
                                                 "guarding", "lss",  "controller", "other"};

/// What a frame means.
struct DecodedFrame {
  std::string_view service;          ///< One of kServices.
  std::optional<std::uint8_t> node;  ///< Empty for frames of the whole bus.
  std::string text;                  ///< For people, without the node.
  std::string fields;  ///< What is special to the service, as members of JSON; empty where not asked for.
  std::vector<ObjectAddress> objects;  ///< Those it carries or names.
};

/// Explains frames one by one: NMT, SYNC, TIME, emergencies in the family's words, PDOs by their mapping, SDO
/// with the object's name and value, heartbeat, node guarding, LSS. Remembers what SDO transfers are under
/// way, and learns PDO mappings from those that read or write them.
class FrameDecoder {
 public:
  struct Options {
    const drive::Profile* profile = nullptr;   ///< May be null; outlives the decoder.
    const drive::Profile* standard = nullptr;  ///< As Desk::standard.
    bool chinese = false;
    bool fields = true;  ///< Whether DecodedFrame::fields are wanted: they take longer than the text.
  };
  explicit FrameDecoder(Options options)
      : options_(options),
        pdos_(options.profile, options.chinese, options.standard),
        modes_(options.profile) {}
  FrameDecoder(const FrameDecoder&) = delete;
  FrameDecoder& operator=(const FrameDecoder&) = delete;

  /// The family of one node, where it is not that of the others; before its first frame. It outlives the
  /// decoder.
  void set_family(std::uint8_t node, const drive::Profile* profile);

  /// The answer holds until the next call.
  const DecodedFrame& decode(const can::Frame& frame);

  show::PdoBook& pdos() { return pdos_; }

 private:
  void decode_service(const can::Frame& frame);
  void decode_nmt(const can::Frame& frame);
  void decode_sync(const can::Frame& frame);
  void decode_time(const can::Frame& frame);
  void decode_emergency(const canopen::Emergency& emergency);
  void decode_pdo(const can::Frame& frame, std::uint8_t node, const show::PdoView* view);
  void decode_lss(const can::Frame& frame);
  void decode_error_control(const can::Frame& frame);
  void decode_sdo(const can::Frame& frame);
  void tell_short_sdo(const can::Frame& frame, bool from_client);
  void add_sdo_fields(const canopen::SdoStep& step, const drive::Target& target);
  void add_sdo_value(const canopen::SdoStep& step, const drive::Target& target);
  void leave_out(std::initializer_list<std::string_view> keys);
  std::string abort_words_of(const canopen::SdoStep& step) const;
  void end_sdo_fields(const canopen::SdoStep& step);
  void learn(const canopen::SdoStep& step);
  const drive::Profile* family_of(std::uint8_t node) const;
  std::string words_of(const Bytes& data, ObjectAddress object, bool chinese) const;
  std::string name_of(const drive::Target& target) const;
  std::string_view word(std::string_view english) const;
  std::string sentence(const std::string& english) const;

  /// A write whose acknowledge has not come.
  struct Pending {
    ObjectAddress object;
    Bytes data;
  };

  Options options_;
  std::array<const drive::Profile*, 128> families_{};  ///< Null: that of the options.
  show::PdoBook pdos_;
  canopen::EmergencyIds emergency_ids_;
  DecodedFrame out_;
  report::JsonWriter fields_{out_.fields};
  std::array<canopen::SdoObserver, 128> channels_;
  std::array<std::optional<Pending>, 128> pending_;
  ModesSeen modes_;
  std::bitset<128> asked_;  ///< Nodes whose answer to a question by node guarding is still to come.
};

}  // namespace servoctl::traffic
