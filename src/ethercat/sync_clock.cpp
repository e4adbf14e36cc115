#include "ethercat/sync_clock.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "ethercat/registers.hpp"

namespace servoctl::ethercat {
namespace {

constexpr std::int64_t kLead = 100'000'000;  ///< ns until the first pulse.
constexpr std::uint8_t kCyclicSync0 = 0x03;
/// Part of a distance that is made good in one cycle, and the most of a cycle that one is moved by.
constexpr int kGain = 4;
constexpr int kClockStep = 16;
/// Locked: no farther from the middle than this part of a cycle.
constexpr int kNear = 8;

std::int64_t nanoseconds(Duration time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time).count();
}

}  // namespace

bool demands_clock(std::uint16_t al_code) {
  constexpr std::array<std::uint16_t, 7> kCodes{0x0027, 0x0028, 0x002C, 0x002D, 0x0030, 0x0035, 0x0036};
  return std::find(kCodes.begin(), kCodes.end(), al_code) != kCodes.end();
}

Request SyncClock::ask_time() const { return read_registers(slave_, reg::kDcSystemTime, size()); }

std::vector<Request> SyncClock::start(std::uint64_t slave_time) {
  const auto cycle = static_cast<std::uint64_t>(nanoseconds(cycle_));
  time_ = slave_time;
  first_ = (slave_time + kLead + cycle - 1) / cycle * cycle;
  locked_ = false;
  return {write_registers(slave_, reg::kDcActivation, {0}),
          write_registers(slave_, reg::kDcCyclicControl, {0}),
          write_registers(slave_, reg::kDcStart, store_le(first_, size())),
          write_registers(slave_, reg::kDcSync0Cycle, store_le(cycle, 4)),
          write_registers(slave_, reg::kDcActivation, {kCyclicSync0})};
}

Request SyncClock::stop() const { return write_registers(slave_, reg::kDcActivation, {0}); }

void SyncClock::serve(Ring& ring, ProcessImage& image) {
  if (ticket_) {
    const auto answer = ring.take_answer(*ticket_);
    if (!answer) return;
    ticket_.reset();
    if (answer->done() && answer->data.size() == size()) measure(counted_on(load_le(answer->data)), image);
  }
  if (image.rhythm().cycles == cycles_) return;
  cycles_ = image.rhythm().cycles;
  Ring::Post how;
  how.urgent = true;
  how.expected = 1;
  how.timeout = cycle_ * 2;
  const auto request = ask_time();
  ticket_ = ring.post(request.command, request.address, request.data, how);
}

/// Less than half a wrap has passed since the time was seen last: it is asked for in every cycle.
std::uint64_t SyncClock::counted_on(std::uint64_t shown) {
  constexpr unsigned kWide = 64;
  if (bits_ == kWide) return shown;
  const auto passed = static_cast<std::uint32_t>(shown) - static_cast<std::uint32_t>(time_);
  time_ += static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(passed)});
  return time_;
}

/// The frame of this cycle passed the slave at that time.
void SyncClock::measure(std::uint64_t slave_time, ProcessImage& image) {
  const auto cycle = nanoseconds(cycle_);
  const auto since = static_cast<std::int64_t>(slave_time - first_);
  const auto phase = (since % cycle + cycle) % cycle;
  const auto late = phase - cycle / 2;
  distance_ = std::chrono::duration_cast<Duration>(std::chrono::nanoseconds(std::abs(late)));
  locked_ = since > 0 && std::abs(late) <= cycle / kNear;
  const auto step = std::clamp(-late / kGain, -cycle / kClockStep, cycle / kClockStep);
  image.shift(std::chrono::duration_cast<Duration>(std::chrono::nanoseconds(step)));
}

void SyncClock::leave(Ring& ring) {
  if (ticket_) ring.forget(*ticket_);
  ticket_.reset();
}

}  // namespace servoctl::ethercat
