#include "drive/homing_method.hpp"

#include <algorithm>
#include <array>

namespace servoctl::drive {
namespace {

/// Methods 17 to 30 are 1 to 14 without the index pulse.
constexpr std::int64_t kWithoutIndex = 16;

/// The pictures of CiA 402-2, homing methods: switch, first direction, edge, last direction. Where a picture
/// shows two starting sides, the second start is on the switch, or right of it (left of it in 11 to 14) with
/// a limit switch to turn round at.
constexpr std::array<HomingMethod, 16> kMethods{{
    {1, Input::negative_limit, -1, +1, +1},
    {2, Input::positive_limit, +1, -1, -1},
    {3, Input::home, +1, -1, -1},
    {4, Input::home, +1, -1, +1},
    {5, Input::home, -1, +1, +1},
    {6, Input::home, -1, +1, -1},
    {7, Input::home, +1, -1, -1, true},
    {8, Input::home, +1, -1, +1, true},
    {9, Input::home, +1, +1, -1, true},
    {10, Input::home, +1, +1, +1, true},
    {11, Input::home, -1, +1, +1, true},
    {12, Input::home, -1, +1, -1, true},
    {13, Input::home, -1, -1, +1, true},
    {14, Input::home, -1, -1, -1, true},
    {33, {}, 0, 0, -1},
    {34, {}, 0, 0, +1},
}};

}  // namespace

bool stays_put(std::int64_t number) { return number == 0 || number == 35 || number == 37; }

std::optional<HomingMethod> homing_method(std::int64_t number) {
  const bool without_index = number > kWithoutIndex && number <= kWithoutIndex + 14;
  const auto like = without_index ? number - kWithoutIndex : number;
  const auto found =
      std::find_if(kMethods.begin(), kMethods.end(), [&](const auto& m) { return m.number == like; });
  if (found == kMethods.end()) return std::nullopt;
  auto method = *found;
  method.number = static_cast<std::int8_t>(number);
  method.index = !without_index;
  return method;
}

std::vector<Input> switches_of(const MotionRules& rules, std::int64_t method) {
  const auto& like = rules.homing_like;
  const auto other = like.find(method);
  const auto known = homing_method(other != like.end() ? other->second : method);
  std::vector<Input> out;
  if (!known || !known->input) return out;
  out.push_back(*known->input);
  if (known->turns) out.push_back(known->seek < 0 ? Input::negative_limit : Input::positive_limit);
  return out;
}

}  // namespace servoctl::drive
