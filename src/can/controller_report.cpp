#include "can/controller_report.hpp"

namespace servoctl::can {
namespace {

/// Classes of error frames, in the identifier.
constexpr std::uint32_t kTransmitTimeout = 0x001;
constexpr std::uint32_t kController = 0x004;
constexpr std::uint32_t kBusOff = 0x040;
constexpr std::uint32_t kRestarted = 0x100;

/// Reports of class kController, in data[1].
constexpr std::uint8_t kOverflow = 0x01 | 0x02;
constexpr std::uint8_t kWarning = 0x04 | 0x08;
constexpr std::uint8_t kPassive = 0x10 | 0x20;
constexpr std::uint8_t kActive = 0x40;

}  // namespace

std::optional<ControllerReport> parse_report(const Frame& frame) {
  if (!frame.error) return std::nullopt;
  if ((frame.id & kBusOff) != 0) return ControllerReport::bus_off;
  if ((frame.id & kRestarted) != 0) return ControllerReport::restarted;
  const std::uint8_t state = (frame.id & kController) != 0 ? frame.data[1] : 0;
  if ((state & kPassive) != 0) return ControllerReport::error_passive;
  if ((state & kOverflow) != 0) return ControllerReport::overflow;
  if ((state & kWarning) != 0) return ControllerReport::error_warning;
  if ((state & kActive) != 0) return ControllerReport::error_active;
  if ((frame.id & kTransmitTimeout) != 0) return ControllerReport::transmit_timeout;
  return std::nullopt;
}

std::string_view text(ControllerReport report) {
  switch (report) {
    case ControllerReport::bus_off: return "bus-off: the controller has left the bus after too many errors";
    case ControllerReport::restarted: return "the controller is back on the bus";
    case ControllerReport::error_passive:
      return "error passive: many errors on the bus; check bitrate, wiring and termination";
    case ControllerReport::error_warning: return "error warning: more errors on the bus than usual";
    case ControllerReport::error_active: return "error active: the bus is healthy again";
    case ControllerReport::overflow: return "frames were lost: they were not read fast enough";
    case ControllerReport::transmit_timeout: return "a frame could not be sent in time";
  }
  return {};
}

}  // namespace servoctl::can
