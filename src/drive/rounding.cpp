// What a number loses in an object that holds whole steps.
#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/quantity.hpp"

namespace servoctl::drive {
namespace {

std::string with_unit(double number, const std::string& unit) {
  return formatted("{}{}{}", plain_number(number, 6), unit.empty() ? "" : " ", unit);
}

}  // namespace

std::string to_string(const Rounding& rounding) {
  const auto& unit = rounding.unit;
  const auto asked = with_unit(rounding.asked, unit);
  const auto held = with_unit(rounding.held, unit);
  return rounding.step == 0
             ? formatted("{} is held as {}", asked, held)
             : formatted("{} is {}: one step is {}", asked, held, with_unit(rounding.step, unit));
}

Result<std::optional<Rounding>> judge_rounding(const Rounding& rounding) {
  const double loss = std::abs(rounding.held - rounding.asked);
  const bool lost = rounding.asked != 0 && rounding.held == 0;
  if (!lost && loss <= kToldLoss * std::abs(rounding.asked)) return std::optional<Rounding>();
  if (!lost && loss <= kMostLoss * std::abs(rounding.asked)) return std::optional(rounding);
  const auto& unit = rounding.unit;
  const auto asked = with_unit(rounding.asked, unit);
  const auto held = with_unit(rounding.held, unit);
  if (rounding.step == 0)
    return fail(Errc::usage, message("{} would become {}: out of range for this object", asked, held));
  const double below = std::floor(rounding.asked / rounding.step) * rounding.step;
  return fail(Errc::usage,
              message("{} would become {}: one step is {}", asked, held, with_unit(rounding.step, unit)),
              message("the nearest values are {} and {}", with_unit(below, unit),
                      with_unit(below + rounding.step, unit)));
}

}  // namespace servoctl::drive
