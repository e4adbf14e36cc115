#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace servoctl {

/// Least, greatest, mean and standard deviation of numbers that come one by one (Welford's method).
class Statistics {
 public:
  void add(double number) {
    least_ = count_ == 0 ? number : std::min(least_, number);
    greatest_ = count_ == 0 ? number : std::max(greatest_, number);
    ++count_;
    const auto step = number - mean_;
    mean_ += step / static_cast<double>(count_);
    squares_ += step * (number - mean_);
  }
  std::uint64_t count() const { return count_; }
  double least() const { return least_; }
  double greatest() const { return greatest_; }
  double mean() const { return mean_; }
  /// Of the whole; 0 for fewer than two numbers.
  double deviation() const { return count_ < 2 ? 0 : std::sqrt(squares_ / static_cast<double>(count_)); }

 private:
  std::uint64_t count_ = 0;
  double least_ = 0;
  double greatest_ = 0;
  double mean_ = 0;
  double squares_ = 0;
};

}  // namespace servoctl
