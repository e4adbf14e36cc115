#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "can/frame.hpp"
#include "canopen/sdo_observer.hpp"
#include "commands/command.hpp"

namespace servoctl::commands {

/// What a frame means.
struct DecodedFrame {
  std::string_view service;          ///< `nmt sync emcy sdo boot-up heartbeat guarding controller other`
  std::optional<std::uint8_t> node;  ///< Empty for frames of the whole bus.
  std::string text;                  ///< For people, without the node.
  report::Record fields;             ///< What is special to the service, for JSON.
};

/// Explains frames of the pre-defined connection set one by one: SDO with the object's name and value, NMT,
/// heartbeat, node guarding, emergencies. Remembers what SDO transfers are under way.
class FrameDecoder {
 public:
  /// `profile` may be null; it outlives the decoder.
  FrameDecoder(const drive::Profile* profile, bool chinese) : profile_(profile), chinese_(chinese) {}

  DecodedFrame decode(const can::Frame& frame);

 private:
  DecodedFrame decode_sdo(const can::Frame& frame);
  DecodedFrame decode_error_control(const can::Frame& frame) const;
  std::string name_of(ObjectAddress object) const;

  const drive::Profile* profile_;
  bool chinese_;
  std::array<canopen::SdoObserver, 128> channels_;
};

}  // namespace servoctl::commands
