#pragma once

#include <cstdint>
#include <utility>

#include "base/time.hpp"
#include "ethercat/registers.hpp"
#include "sim/esc_memory.hpp"

namespace servoctl::sim {

/// The watchdog over the outputs of an EtherCAT slave (0400h, 0420h, 0440h, 0442h): it runs from the first
/// outputs on, and ends when none come for so long. Reads no clock.
class EscWatchdog {
 public:
  /// What it waits by its registers; zero: it is off.
  static Duration period(const EscMemory& memory) {
    const auto step = (std::uint64_t{memory.word(ethercat::reg::kWatchdogDivider)} + 2) * 40;
    const std::chrono::nanoseconds all(step * memory.word(ethercat::reg::kSmWatchdog));
    return std::chrono::ceil<Duration>(all);
  }

  void reset() { *this = {}; }
  void trigger(const EscMemory& memory, TimePoint now) {
    const auto wait = period(memory);
    ends_ = wait == Duration::zero() ? kNever : now + wait;
    expired_ = false;
  }
  /// It watches no longer; what it has counted stays.
  void stop() { ends_ = kNever; }
  /// True once, when it ends.
  bool on_time(TimePoint now) {
    if (now < ends_) return false;
    ends_ = kNever;
    expired_ = true;
    if (count_ < 0xFF) ++count_;
    return true;
  }
  TimePoint deadline() const { return ends_; }
  /// 0440h bit 0: outputs come in time, or nobody watches.
  bool is_content(const EscMemory& memory) const {
    return period(memory) == Duration::zero() || (ends_ != kNever && !expired_);
  }
  std::uint8_t count() const { return count_; }
  void clear_count() { count_ = 0; }

 private:
  TimePoint ends_ = kNever;
  bool expired_ = false;
  std::uint8_t count_ = 0;
};

}  // namespace servoctl::sim
