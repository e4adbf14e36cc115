#include "motion/turn_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/decade.hpp"
#include "base/format.hpp"
#include "base/number.hpp"

namespace servoctl::motion {
namespace {

constexpr std::size_t kParts = 10;
constexpr std::size_t kLeastLooks = 5 * kParts;
constexpr double kMostSpread = 0.05;    ///< Of the parts, as their standard deviation.
constexpr double kMostQuarrel = 0.02;   ///< Between 606Ch and the way.
constexpr double kWrap = 4294967296.0;  ///< 6064h has 32 bits.
constexpr std::array kRound{1.0, 2.0, 2.5, 3.6, 4.0, 5.0, 8.0};

tl::unexpected<Error> no_number(Message message, Message hint) {
  return fail(Errc::negative, std::move(message), std::move(hint));
}

double seconds_between(const TurnLook& a, const TurnLook& b) {
  return std::chrono::duration<double>(b.time - a.time).count();
}

double way_between(const TurnLook& a, const TurnLook& b) {
  const double moved = b.position - a.position;
  return moved - kWrap * std::round(moved / kWrap);
}

/// Of a stretch of looks.
struct Stretch {
  double way = 0;
  double turns = 0;
  double increments() const { return std::abs(way / turns); }
};

Stretch stretch_of(std::span<const TurnLook> looks) {
  Stretch out;
  for (std::size_t i = 1; i < looks.size(); ++i) {
    out.way += way_between(looks[i - 1], looks[i]);
    out.turns += (looks[i - 1].rpm + looks[i].rpm) / 2 / 60 * seconds_between(looks[i - 1], looks[i]);
  }
  return out;
}

double standard_deviation(const std::vector<double>& values) {
  double mean = 0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

std::string percent(double part) { return plain_number(part * 100, 2); }

/// By 606Ch.
double by_speed(std::span<const TurnLook> looks, double rpm) {
  double sum = 0;
  for (const auto& look : looks) sum += look.speed / static_cast<double>(looks.size());
  return std::abs(sum * 60 / rpm);
}

bool is_near(double measured, double candidate) {
  return std::abs(measured / candidate - 1) <= kTurnTolerance;
}

/// By its ratio: which power it is.
int nearest_power_of_two(double measured) {
  int digits = 0;
  (void)std::frexp(measured * std::numbers::sqrt2, &digits);
  return digits - 1;
}

double nearest_decimal(double measured) {
  const double power = power_of_ten(decade_of(measured));
  double out = 10 * power;
  for (const double mantissa : kRound)
    if (std::abs(mantissa * power - measured) < std::abs(out - measured)) out = mantissa * power;
  return out;
}

std::string distance(double measured, double candidate) {
  return formatted("{} % from the {} that were measured", percent(std::abs(measured / candidate - 1)),
                   std::llround(measured));
}

/// What each part of the measurement says by itself.
std::vector<double> parts_of(std::span<const TurnLook> looks) {
  std::vector<double> out;
  for (std::size_t i = 0; i < kParts; ++i) {
    const auto begin = i * (looks.size() - 1) / kParts;
    const auto end = (i + 1) * (looks.size() - 1) / kParts;
    out.push_back(stretch_of(looks.subspan(begin, end - begin + 1)).increments());
  }
  return out;
}

}  // namespace

Result<TurnMeasurement> measure_turn(std::span<const TurnLook> looks, double step) {
  if (looks.size() < kLeastLooks)
    return no_number(message("answered only {} times while turning: too few samples", looks.size()),
                     "measure for longer (--for 20s), or keep other traffic off the bus");
  const auto whole = stretch_of(looks);
  const bool one_way = std::all_of(looks.begin(), looks.end(),
                                   [&](const TurnLook& look) { return look.rpm * looks.front().rpm > 0; });
  if (!one_way || whole.turns == 0 || whole.way == 0)
    return no_number("did not turn evenly: its monitor or its position stood still, or changed direction",
                     std::string(kOtherWay));
  TurnMeasurement out;
  out.increments = whole.increments();
  out.turns = std::abs(whole.turns);
  out.seconds = seconds_between(looks.front(), looks.back());
  out.rpm = out.turns / out.seconds * 60;
  out.looks = looks.size();
  const auto parts = parts_of(looks);
  const double spread = standard_deviation(parts) / out.increments;
  if (!(spread <= kMostSpread)) {
    const auto [least, most] = std::minmax_element(parts.begin(), parts.end());
    return no_number(
        message(
            "shows a speed that does not match its position: {} to {} increments per revolution in parts of "
            "the measurement",
            std::llround(*least), std::llround(*most)),
        std::string("does the motor turn evenly? ") + std::string(kOtherWay));
  }
  out.by_speed = by_speed(looks, out.rpm);
  if (std::abs(out.by_speed / out.increments - 1) > kMostQuarrel)
    return no_number(message("reports two speeds: a revolution has {} increments by 606Ch, {} by 6064h",
                             std::llround(out.by_speed), std::llround(out.increments)),
                     std::string(kOtherWay));
  out.uncertainty = step / out.rpm + 2 * spread / std::sqrt(static_cast<double>(kParts));
  if (out.uncertainty > kTurnTolerance)
    return no_number(message("has about {} increments per revolution ± {} %; only 1 % is allowed",
                             std::llround(out.increments), percent(out.uncertainty)),
                     message("measure for longer (--for 20s), or faster (--speed 30rpm); {}", kOtherWay));
  return out;
}

Result<TurnCounts> counts_behind(double measured, double uncertainty, const TurnExpectation& expected) {
  if (expected.told) {
    const auto told = std::llround(*expected.told);
    if (is_near(measured, *expected.told))
      return TurnCounts{*expected.told,
                        formatted("given by --nameplate, {}", distance(measured, *expected.told))};
    return no_number(message("has {} measured counts per revolution (± {} %), not the {} of --nameplate",
                             std::llround(measured), percent(uncertainty), told),
                     "leave --nameplate out, or check the motor's nameplate");
  }
  const int bits = nearest_power_of_two(measured);
  if (const double power = std::ldexp(1, bits); is_near(measured, power))
    return TurnCounts{power, formatted("2^{}: {}", bits, distance(measured, power))};
  const double decimal = nearest_decimal(measured);
  const auto said =
      message("has {} measured counts per revolution (± {} %)", std::llround(measured), percent(uncertainty));
  if (!is_near(measured, decimal))
    return no_number(
        said + ": neither a power of two nor a round decimal number is within 1 % of it",
        message(
            "check the motor's nameplate; `units learn -n {} --nameplate COUNTS` measures again, compares "
            "COUNTS with the result and keeps it",
            node_name(expected.node)));
  if (expected.disputed)
    return no_number(
        message(
            "{}: {} is near, but the manual gives two scales for the speed monitor, and with the other it "
            "would be {}",
            said, std::llround(decimal), plain_number(decimal / 10, 12)),
        message(
            "check the motor's nameplate; if it agrees, `units learn -n {} --nameplate {}` measures again "
            "and keeps it",
            node_name(expected.node), as_it_is(std::llround(decimal))));
  return TurnCounts{
      decimal, formatted("a round decimal number, {}; no power of two is near", distance(measured, decimal))};
}

}  // namespace servoctl::motion
