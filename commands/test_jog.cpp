#include <fmt/format.h>

#include "base/number.hpp"
#include "command/command.hpp"
#include "command/motion_options.hpp"
#include "command/trial_options.hpp"
#include "trial/motion_trials.hpp"
#include "trial/verdict.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr auto kTestJogParameters = with_motion_options(std::to_array<Parameter>({
    {.name = "speed",
     .help = "60rpm; the sign is the first direction",
     .kind = Kind::value,
     .required = true},
    {.name = "--for", .help = "how long in each direction (default 2s)", .kind = Kind::duration},
    {.name = "--tolerance", .help = "how far the speed may be off, in % (default 10)", .kind = Kind::number},
    {.name = "--stop-within", .help = "longest time to standstill (default 1s)", .kind = Kind::duration},
    kAccelerationOption,
    kCsvOption,
    kJunitOption,
}));

Result<report::Value> run_test_jog(Context& context, const Arguments& arguments) {
  const auto test = parse_jog_test(arguments, arguments.text("speed"));
  if (!test) return fail(test.error());
  const auto request = motion_request(context, arguments);
  if (!request) return fail(request.error());
  auto done = trial::test_jog(context, *request, *test);
  if (!done) return fail(done.error());
  if (!done->result) return std::move(done->plan);
  return trial::verdicts(context, verdict_options(arguments), {std::move(*done->result)});
}

Result<void> check_test_jog(Context& context, const Arguments& arguments) {
  if (const auto test = parse_jog_test(arguments, arguments.text("speed")); !test) return fail(test.error());
  return check_motion_words(context, arguments, drive::Use::jog, {written_speed("speed")});
}

constexpr Example kTestJogExamples[] = {
    {"test jog 60rpm -n 1 -d gsd600 --turn 131072",
     "131072 counts a turn: take your motor's, a wrong number is a wrong speed"},
    {"test jog 100rpm --for 5s --tolerance 5 --junit jog.xml -n 1 -d sv2", "stricter, with a file for a CI"},
};

}  // namespace

extern const Command kTestJog;
const Command kTestJog{
    .path = "test jog",
    .summary = "Turn a motor both ways, with a verdict",
    .details =
        "Checks, asks, moves and ends as `jog` does, once in each direction. Passes if the motor turned in "
        "the commanded direction, held its speed within --tolerance in the second half of the time, its "
        "following error grew by at most 1 % of the distance, it stood still within --stop-within of the "
        "stop command, and the drive was left disabled. What a drive does not report is skipped. --plot "
        "plots, --csv saves the samples. Exit code 1 if it fails.",
    .parameters = kTestJogParameters,
    .examples = kTestJogExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::moves,
    .run = run_test_jog,
    .check = check_test_jog,
};

}  // namespace servoctl::commands
