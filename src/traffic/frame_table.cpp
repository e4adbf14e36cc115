#include "traffic/frame_table.hpp"

#include "base/format.hpp"
#include "canopen/pdo.hpp"

namespace servoctl::traffic {

show::LiveView::Layout FrameTable::layout() {
  return {.columns = {{.title = "CAN-ID", .right = true},
                      {.title = "node", .right = true},
                      {.title = "count", .right = true},
                      {.title = "ms", .right = true},
                      {.title = "last"}},
          .plots = false};
}

void FrameTable::add(Duration time, const can::Frame& frame, const DecodedFrame& decoded) {
  const auto id = canopen::can_id_of(frame);
  auto& rhythm = rhythms_[id];
  rhythm.add(TimePoint(time));
  const auto& intervals = rhythm.intervals();
  const auto shown = formatted("{:03X}", frame.id);
  view_->set(formatted("{:08X}", id),
             {shown, decoded.node ? formatted("{}", *decoded.node) : std::string("-"),
              formatted("{}", rhythm.count()),
              intervals.count() == 0 ? std::string() : formatted("{:.1f}", intervals.mean()), decoded.text});
}

}  // namespace servoctl::traffic
