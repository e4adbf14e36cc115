#include "command/command.hpp"
#include "command/motion_options.hpp"
#include "command/trial_options.hpp"
#include "drive/standard_objects.hpp"
#include "trial/motion_trials.hpp"
#include "trial/verdict.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr auto kTestHomeParameters = with_motion_options(std::to_array<Parameter>({
    {.name = "method", .help = "number in 6098h (default: the present one)", .kind = Kind::value},
    {.name = "--repeat", .help = "runs (default 5)", .kind = Kind::number},
    {.name = "--spread",
     .help = "greatest spread that passes, in the unit of the position (default 1)",
     .kind = Kind::number},
    kEncoderOption,
    kCsvOption,
    kJunitOption,
}));

Result<report::Value> run_test_home(Context& context, const Arguments& arguments) {
  const auto test = parse_home_test(arguments, arguments.text("method"));
  if (!test) return fail(test.error());
  const auto request = motion_request(context, arguments);
  if (!request) return fail(request.error());
  auto done = trial::test_home(context, *request, *test);
  if (!done) return fail(done.error());
  if (!done->result) return std::move(done->plan);
  return trial::verdicts(context, verdict_options(arguments), {std::move(*done->result)});
}

Result<void> check_test_home(Context& context, const Arguments& arguments) {
  if (const auto test = parse_home_test(arguments, arguments.text("method")); !test)
    return fail(test.error());
  return check_motion_words(
      context, arguments, drive::Use::home,
      {{.word = "method", .object = objects::kHomingMethod, .least = motion::WrittenQuantity::Least::any}});
}

constexpr Example kTestHomeExamples[] = {
    {"test home 17 --limit 900rpm --spread 1 -n 1 -d sv2 --panel PA-20=0,PA-74=1",
     "five times at 900 rpm (from the factory), home within one degree"},
    {"test home --limit 600rpm --window 5rev -n 1 -d gsd600 --turn 131072",
     "by the method set in the drive, 5 turns at most; 131072: your motor's counts"},
};

}  // namespace

extern const Command kTestHome;
const Command kTestHome{
    .path = "test home",
    .summary = "Home an axis several times, with a verdict",
    .details =
        "Checks, asks, moves and ends as `home` does, --repeat times. Passes if every run finds home, and "
        "neither the final position nor home against the encoder's own count (6063h, or the family's own "
        "object) spreads by more than --spread. --encoder gives the encoder counts per revolution if the "
        "drive does not report them; a drive that also zeroes the encoder count shows no spread there. "
        "Exit code 1 when it fails.",
    .parameters = kTestHomeParameters,
    .examples = kTestHomeExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::moves,
    .run = run_test_home,
    .check = check_test_home,
};

}  // namespace servoctl::commands
