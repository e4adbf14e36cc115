#pragma once

#include <string>
#include <vector>

namespace servoctl {

/// One quantity over time, as a plot or a CSV file shows it. `seconds` and `values` are of the same length.
struct Series {
  std::string name;             ///< `position`
  std::string unit;             ///< `deg`; empty where nothing tells it.
  std::vector<double> seconds;  ///< Since the beginning of the recording, rising.
  std::vector<double> values;
};

}  // namespace servoctl
