#include "canopen/sync.hpp"

#include <utility>

namespace servoctl::canopen {

can::Frame sync_frame(std::optional<std::uint8_t> counter, std::uint32_t can_id) {
  can::Frame out;
  out.id = can_id;
  if (!counter) return out;
  out.size = 1;
  out.data[0] = *counter;
  return out;
}

void SyncProducer::on_time(TimePoint now) {
  if (now < next_) return;
  const auto late = (now - next_) / options_.period;
  missed_ += static_cast<std::uint64_t>(late);
  next_ += (late + 1) * options_.period;
  if (options_.last_counter == 0) {
    tx_ = sync_frame({}, options_.can_id);
    return;
  }
  counter_ = counter_ >= options_.last_counter ? std::uint8_t{1} : static_cast<std::uint8_t>(counter_ + 1);
  tx_ = sync_frame(counter_, options_.can_id);
}

std::optional<can::Frame> SyncProducer::take_frame() { return std::exchange(tx_, std::nullopt); }

}  // namespace servoctl::canopen
