#include "command/trial_options.hpp"

#include "base/format.hpp"
#include "base/number.hpp"
#include "command/duration_option.hpp"

namespace servoctl::command {
namespace {

/// The second half of a shorter one would still be the ramp.
constexpr Duration kShortest = std::chrono::seconds(1);

/// A number of at least 0; `otherwise` when it is not given. Errc::usage.
Result<double> number_option(const Arguments& arguments, std::string_view name, double otherwise) {
  if (!arguments.has(name)) return otherwise;
  const auto number = parse_real(arguments.text(name));
  if (!number || *number < 0)
    return fail(Errc::usage,
                message("{}: '{}' is not a number of 0 or more", name, as_it_is(arguments.text(name))));
  return *number;
}

}  // namespace

Result<trial::JogTrial> parse_jog_test(const Arguments& arguments, std::string_view speed) {
  trial::JogTrial out;
  out.speed = speed;
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  out.length = length->value_or(out.length);
  if (out.length < kShortest)
    return fail(Errc::usage, "--for is too short to reach the speed", "at least 1s");
  const auto stop = duration_option(arguments, "--stop-within");
  if (!stop) return fail(stop.error());
  out.longest_stop = stop->value_or(out.longest_stop);
  const auto tolerance = number_option(arguments, "--tolerance", out.tolerance);
  if (!tolerance) return fail(tolerance.error());
  out.tolerance = *tolerance;
  return out;
}

Result<trial::HomeTrial> parse_home_test(const Arguments& arguments, std::string_view method) {
  trial::HomeTrial out;
  out.method = method;
  const auto repeat = count_option(arguments, "--repeat", 1, 1000, out.repeat);
  if (!repeat) return fail(repeat.error());
  out.repeat = *repeat;
  const auto spread = number_option(arguments, "--spread", out.spread);
  if (!spread) return fail(spread.error());
  out.spread = *spread;
  return out;
}

Result<std::uint32_t> count_option(const Arguments& arguments, std::string_view name, std::uint32_t least,
                                   std::uint32_t most, std::uint32_t otherwise) {
  if (!arguments.has(name)) return otherwise;
  const auto number = parse_digits(arguments.text(name), 10);
  if (!number || *number < least || *number > most)
    return fail(Errc::usage, message("{}: '{}' is not a number from {} to {}", name,
                                     as_it_is(arguments.text(name)), least, most));
  return static_cast<std::uint32_t>(*number);
}

trial::VerdictOptions verdict_options(const Arguments& arguments) {
  trial::VerdictOptions out;
  out.plot = arguments.has("--plot");
  if (arguments.has("--junit")) out.junit = std::string(arguments.text("--junit"));
  return out;
}

}  // namespace servoctl::command
