#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "od/eds.hpp"

namespace servoctl::od {

/// What an EDS says of itself (CiA 306-1, 4.5.1 and 4.5.2).
struct EdsHead {
  std::string file_name;
  std::string description;
  std::string date;  ///< `11-28-2026`
  std::string time;  ///< `06:12PM`
  std::vector<std::string> comments = {};
};

/// A time of ISO 8601, `2026-11-18T11:06:40Z`, as CiA 306-1, 4.6.1 writes it; empty for what is none.
struct EdsTime {
  std::string date;  ///< `11-18-2026`
  std::string time;  ///< `11:06AM`
};
EdsTime eds_time(std::string_view iso);

/// An EDS with these objects (CiA 306-1); sub-indices in hexadecimal, bitrates only where they are known.
/// What a line cannot hold of a name is left out. The same input gives the same text.
std::string write_eds(const EdsHead& head, const DeviceInfo& device, const Dictionary& dictionary);

}  // namespace servoctl::od
