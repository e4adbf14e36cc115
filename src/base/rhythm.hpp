#pragma once

#include <cstdint>
#include <optional>

#include "base/statistics.hpp"
#include "base/time.hpp"

namespace servoctl {

/// In what intervals something happens.
class Rhythm {
 public:
  void add(TimePoint time) {
    ++count_;
    if (last_) intervals_.add(std::chrono::duration<double, std::milli>(time - *last_).count());
    last_ = time;
  }
  std::uint64_t count() const { return count_; }
  const Statistics& intervals() const { return intervals_; }  ///< In milliseconds.

 private:
  std::uint64_t count_ = 0;
  std::optional<TimePoint> last_;
  Statistics intervals_;
};

}  // namespace servoctl
