#pragma once

#include <cmath>

#include "base/rhythm.hpp"
#include "report/value.hpp"

namespace servoctl::traffic {

/// Headings of rhythm_cells().
inline std::vector<report::Table::Column> rhythm_columns() {
  return {{"count"},
          {"per_second", "a second"},
          {"period_mean_ms", "mean (ms)"},
          {"period_min_ms", "min (ms)"},
          {"period_max_ms", "max (ms)"},
          {"period_deviation_ms", "jitter σ (ms)"}};
}

/// How often, and the intervals to a microsecond; empty where there were not two.
inline report::List rhythm_cells(const Rhythm& rhythm) {
  report::List out{rhythm.count()};
  const auto& intervals = rhythm.intervals();
  if (intervals.count() == 0) return out.resize(6), out;
  const auto rounded = [](double number) { return report::Value(std::round(number * 1000) / 1000); };
  out.push_back(intervals.mean() > 0 ? rounded(1000 / intervals.mean()) : report::Value());
  for (const double number :
       {intervals.mean(), intervals.least(), intervals.greatest(), intervals.deviation()})
    out.push_back(rounded(number));
  return out;
}

}  // namespace servoctl::traffic
