#include "traffic/bus_picture.hpp"

#include "canopen/cob_id.hpp"

namespace servoctl::traffic {

void BusPicture::add(const can::Frame& frame, TimePoint time) {
  if (frame.error) {
    if (const auto error = can::parse_wire_error(frame)) {
      errors_.add(*error);
      while_sending_ += can::while_sending(frame);
      if (const auto wires = can::transceiver_text(frame); !wires.empty()) wires_ = wires;
    }
    if (const auto report = can::parse_report(frame)) ++reports_[static_cast<std::size_t>(*report)];
    return;
  }
  ++frames_;
  load_.add(frame, time);
  extended_ += frame.extended;
  duplicates_.on_frame(frame, time);
  const auto first = static_cast<std::uint32_t>(canopen::kErrorControl);
  if (!frame.extended && !frame.remote && frame.id > first && frame.id <= first + canopen::kLastNode)
    nodes_.insert(static_cast<std::uint8_t>(frame.id - first));
}

}  // namespace servoctl::traffic
