#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace servoctl::od {

/// A unit and what one of the raw value is in it.
struct EsiUnit {
  std::string unit;
  double scale = 1;
};

/// The unit behind a number of CiA 303-2, as 60A8h, 60A9h and 60AAh hold it: power of ten, numerator and
/// denominator in the upper three bytes; `0x00B44700` is rpm. Empty for one that is not known here.
std::optional<EsiUnit> si_unit(std::uint32_t code);

/// The unit of an object: a number of ETG.1004 (as in CiA 303-2: power of ten, numerator and denominator in
/// the upper three bytes; `#xFD030000` is ms), or a text as it is. Empty for a number that is not known
/// here: a value without a unit says nothing wrong.
std::optional<EsiUnit> esi_unit(std::string_view text);

}  // namespace servoctl::od
