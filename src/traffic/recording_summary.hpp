#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "base/rhythm.hpp"
#include "canopen/sdo_observer.hpp"
#include "report/value.hpp"
#include "traffic/frame_decoder.hpp"

namespace servoctl::traffic {

/// What a recording shows as a whole: nodes with their states and heartbeats, periods, emergencies, SDO
/// aborts, requests without an answer, gaps.
class RecordingSummary {
 public:
  /// `families`: of nodes that are not of the desk's own; both outlive the summary.
  RecordingSummary(const show::Desk& desk, const std::map<std::uint8_t, const drive::Profile*>& families);

  void add(Duration time, const can::Frame& frame);
  /// After the last frame.
  void end();
  std::size_t count() const { return frames_; }
  /// `begin`: date and time of day of the first frame, empty where the recording has none.
  report::Record record(std::string_view begin) const;

 private:
  using State = std::optional<std::uint16_t>;

  struct Node {
    std::size_t frames = 0;
    std::size_t boot_ups = 0;
    std::size_t aborts = 0;
    std::size_t unanswered = 0;
    std::string_view nmt;  ///< The last that it told.
    State statusword;      ///< The last that was seen.
    Rhythm heartbeats;
    double slowest_ms = 0;  ///< Of its answers to SDO requests.
  };
  struct Times {
    std::size_t count = 0;
    Duration first{};
    Duration last{};
    void add(Duration time);
  };
  struct Request {
    ObjectAddress object;
    Duration time{};
  };
  struct Cycle {
    std::string name;
    std::optional<std::uint8_t> node;
    Rhythm rhythm;
  };

  const drive::Profile* family_of(std::uint8_t node) const;
  void add_sdo(Duration time, const can::Frame& frame, std::uint8_t id);
  void add_state(const can::Frame& frame, const DecodedFrame& decoded);
  void miss(std::uint8_t id);
  double seconds(Duration time) const;
  bool is_wanted(std::uint8_t node) const;
  report::Table nodes_table() const;
  report::Table periods_table() const;
  report::Table emergencies_table() const;
  report::Table aborts_table() const;
  report::Table unanswered_table() const;

  const show::Desk* desk_;
  const std::map<std::uint8_t, const drive::Profile*>* own_families_;
  FrameDecoder decoder_;
  std::size_t frames_ = 0;
  Duration begin_{};
  Duration last_{};
  Duration gap_{};     ///< The longest without a frame.
  Duration gap_at_{};  ///< Where it begins.
  std::map<std::string_view, std::size_t> services_;
  std::map<std::uint8_t, Node> nodes_;
  std::map<std::uint32_t, Cycle> cycles_;  ///< SYNC and PDOs, by CAN-ID.
  std::map<std::pair<std::uint8_t, std::uint16_t>, Times> emergencies_;
  std::map<std::tuple<std::uint8_t, ObjectAddress, std::uint32_t>, Times> aborts_;
  std::map<std::pair<std::uint8_t, ObjectAddress>, Times> unanswered_;
  std::array<canopen::SdoObserver, 128> channels_;
  std::array<std::optional<Request>, 128> open_;
};

}  // namespace servoctl::traffic
