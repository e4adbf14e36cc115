#include "base/duration.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl {
namespace {

constexpr std::array<std::pair<std::string_view, double>, 4> kUnits{
    {{"us", 1.0}, {"ms", 1e3}, {"s", 1e6}, {"min", 60e6}}};
constexpr double kDay = 86'400e6;

}  // namespace

std::optional<Duration> parse_duration(std::string_view text) {
  text = trim(text);
  double number = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{}) return std::nullopt;
  const auto unit = trim(text.substr(static_cast<std::size_t>(stop - text.data())));
  double factor = 0;
  for (const auto& row : kUnits)
    if (row.first == unit) factor = row.second;
  const double micros = number * factor;
  if (factor == 0 || !std::isfinite(micros) || micros < 0 || micros > kDay) return std::nullopt;
  const Duration out(static_cast<Duration::rep>(std::llround(micros)));
  return micros > 0 && out == Duration::zero() ? std::nullopt : std::optional(out);
}

Result<Duration> read_duration(std::string_view text) {
  if (const auto time = parse_duration(text)) return *time;
  text = trim(text);
  if (parse_real(text) || parse_integer(text))
    return fail(Errc::usage, message("'{}': a time needs its unit", as_it_is(text)),
                message("write {0}s or {0}ms", text));
  return fail(Errc::usage, message("'{}' is not a time", as_it_is(text)),
              "write 500ms, 2s or 1min; at most one day");
}

std::string to_string(Duration duration) {
  const auto micros = duration.count();
  if (micros % 1'000'000 == 0) return std::to_string(micros / 1'000'000) + " s";
  if (micros % 1000 == 0) return std::to_string(micros / 1000) + " ms";
  return std::to_string(micros) + " us";
}

}  // namespace servoctl
