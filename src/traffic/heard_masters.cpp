#include "traffic/heard_masters.hpp"

#include <chrono>

#include "canopen/sdo_frame.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::traffic {
namespace {

/// An end is noticed some periods after the last heartbeat.
constexpr Duration kBefore = std::chrono::seconds(3);

/// An EMCY, a PDO, an answer to an SDO or a boot-up.
bool tells_of_drive(const can::Frame& frame) {
  if (frame.extended || frame.remote || frame.error) return false;
  const auto function = frame.id & 0x780U;
  const bool boot_up = function == 0x700 && frame.size == 1 && frame.data[0] == 0;
  return boot_up || function == 0x080 || function == 0x180 || function == 0x280 || function == 0x380 ||
         function == 0x480 || function == 0x580;
}

}  // namespace

void HeardMasters::on_frame(const can::Frame& frame, TimePoint time) {
  if (tells_of_drive(frame)) drives_.insert(static_cast<std::uint8_t>(frame.id & 0x7FU));
  const auto write = canopen::sdo_write_request(frame);
  if (!write || write->object.index != objects::kConsumerHeartbeatIndex || frame.size != 8) return;
  const auto producer = static_cast<std::uint8_t>(frame.data[6] & 0x7FU);
  const bool on = (frame.data[4] | frame.data[5]) != 0 && producer != 0;
  auto& entry = entries_[{write->node, write->object.sub}];
  if (entry != 0) left_[entry] = time;
  entry = on ? producer : std::uint8_t{0};
  for (const auto& [place, consumed] : entries_) left_.erase(consumed);
}

bool HeardMasters::has_left(std::uint8_t producer, TimePoint noticed) const {
  const auto left = left_.find(producer);
  return left != left_.end() && noticed - left->second <= kBefore && drives_.count(producer) == 0;
}

}  // namespace servoctl::traffic
