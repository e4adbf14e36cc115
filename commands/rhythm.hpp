#pragma once

#include <optional>

#include "base/statistics.hpp"
#include "base/time.hpp"
#include "report/value.hpp"

namespace servoctl::commands {

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

  /// Headings of cells().
  static std::vector<report::Table::Column> columns() {
    return {{"count"},
            {"per_second", "a second"},
            {"period_mean_ms", "mean (ms)"},
            {"period_min_ms", "min (ms)"},
            {"period_max_ms", "max (ms)"},
            {"period_deviation_ms", "jitter σ (ms)"}};
  }
  /// How often, and the intervals to a microsecond; empty where there were not two.
  report::List cells() const {
    report::List out{count_};
    if (intervals_.count() == 0) return out.resize(6), out;
    const auto rounded = [](double number) { return report::Value(std::round(number * 1000) / 1000); };
    out.push_back(intervals_.mean() > 0 ? rounded(1000 / intervals_.mean()) : report::Value());
    for (const double number :
         {intervals_.mean(), intervals_.least(), intervals_.greatest(), intervals_.deviation()})
      out.push_back(rounded(number));
    return out;
  }

 private:
  std::uint64_t count_ = 0;
  std::optional<TimePoint> last_;
  Statistics intervals_;
};

}  // namespace servoctl::commands
