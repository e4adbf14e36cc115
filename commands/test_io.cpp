#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "command/trial_options.hpp"
#include "trial/io_trial.hpp"
#include "trial/verdict.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kTestIoParameters[] = {
    {.name = "--expect",
     .help = "inputs that must be seen at 0 and at 1: negative-limit, positive-limit, home, bit16, …",
     .kind = Kind::text},
    {.name = "--for", .help = "longest wait for them (default 30s)", .kind = Kind::duration},
    kJunitOption,
};

Result<report::Value> run_test_io(Context& context, const Arguments& arguments) {
  if (context.nodes.size() != 1) return fail(Errc::usage, "'test io' watches one drive", "name it: -n 1");
  trial::InputTrial test;
  auto expected = trial::parse_inputs(context, arguments.text("--expect"));
  if (!expected) return fail(expected.error());
  test.expected = std::move(*expected);
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  test.length = length->value_or(test.length);
  auto result = trial::test_inputs(context, context.nodes.front(), test);
  if (!result) return fail(result.error());
  return trial::verdicts(context, verdict_options(arguments), {std::move(*result)});
}

constexpr Example kTestIoExamples[] = {
    {"test io --expect negative-limit,positive-limit,home -n 1 -d gsd600",
     "ends when each of the three was seen at 0 and at 1"},
    {"test io --for 1min -n 1 -d gsd600", "show every change for a minute"},
};

}  // namespace

extern const Command kTestIo;
const Command kTestIo{
    .path = "test io",
    .summary = "Watch the inputs of a drive while you actuate them, with a verdict",
    .details =
        "Reads 60FDh every 10 ms and reports each change. With --expect it passes, and ends, once every "
        "input named has been seen at 0 and at 1; without, it watches until the time is over (or Ctrl-C) and "
        "passes if any input changed. 0 and 1 are the bits as the drive sends them: whether 1 means actuated "
        "depends on the family and on the wiring. Exit code 1 if it fails. Moves nothing.",
    .parameters = kTestIoParameters,
    .examples = kTestIoExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .family = FamilyCheck::always,
    .run = run_test_io,
    .goes_on = true,
};

}  // namespace servoctl::commands
