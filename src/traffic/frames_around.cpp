#include "traffic/frames_around.hpp"

#include "canopen/cob_id.hpp"
#include "canopen/emergency.hpp"
#include "canopen/error_control.hpp"

namespace servoctl::traffic {

bool FramesAround::is_occasion(const can::Frame& frame) const {
  if (occasion_ == "error") return frame.error;
  if (frame.error || frame.remote || frame.extended) return false;
  if (occasion_ == "emcy") {
    const auto emergency = canopen::parse_emergency(frame);
    return emergency && !emergency->is_reset();
  }
  if (occasion_ == "boot-up") {
    const auto message = canopen::parse_error_control(frame);
    return message && message->boot_up;
  }
  constexpr std::uint8_t kAbort = 0x80;
  const bool sdo = frame.id > canopen::kSdoAnswer && frame.id <= canopen::kSdoRequest + canopen::kLastNode;
  return sdo && frame.size == frame.data.size() && frame.data[0] == kAbort;
}

void FramesAround::add(const can::LogFrame& line) {
  while (!waiting_.empty() && line.time - waiting_.front().time > reach_) {
    pass_(waiting_.front());
    waiting_.pop_front();
  }
  if (is_occasion(line.frame)) {
    ++occasions_;
    last_ = line.time;
    for (const auto& before : waiting_) show_(before);
    waiting_.clear();
  }
  if (last_ && line.time - *last_ <= reach_)
    show_(line);
  else
    waiting_.push_back(line);
}

void FramesAround::end() {
  for (const auto& line : waiting_) pass_(line);
  waiting_.clear();
}

}  // namespace servoctl::traffic
