#include "traffic/heard_masters.hpp"

#include <chrono>

#include "canopen/sdo_frame.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::traffic {
namespace {

/// An end is noticed some periods after the last heartbeat.
constexpr Duration kBefore = std::chrono::seconds(3);

constexpr std::uint8_t kExpeditedFour = 0x23;  ///< A write of four bytes (CiA 301, 7.2.4.3.3).
constexpr std::uint8_t kConfirmed = 0x60;

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
  if (frame.extended || frame.remote || frame.error || frame.size != 8) return;
  const auto object = canopen::sdo_object(frame);
  if (object.index != objects::kConsumerHeartbeatIndex) return;
  const Place place{static_cast<std::uint8_t>(frame.id & 0x7FU), object.sub};
  if (canopen::sdo_write_request(frame)) {
    asked_.erase(place);
    // Of other writes the value is in frames that follow.
    if (frame.data[0] != kExpeditedFour) return void(entries_.erase(place));
    const bool on = (frame.data[4] | frame.data[5]) != 0;
    asked_[place] = on ? static_cast<std::uint8_t>(frame.data[6] & 0x7FU) : std::uint8_t{0};
  } else if ((frame.id & 0x780U) == 0x580) {
    if (frame.data[0] == kConfirmed) on_confirmed(place, time);
    asked_.erase(place);
  }
}

void HeardMasters::on_confirmed(const Place& place, TimePoint time) {
  const auto asked = asked_.find(place);
  if (asked == asked_.end()) return;
  auto& entry = entries_[place];
  if (entry != 0) left_[entry] = time;
  entry = asked->second;
  for (const auto& [where, consumed] : entries_) left_.erase(consumed);
}

bool HeardMasters::has_left(std::uint8_t producer, TimePoint noticed) const {
  const auto left = left_.find(producer);
  return left != left_.end() && noticed - left->second <= kBefore && drives_.count(producer) == 0;
}

}  // namespace servoctl::traffic
