#include "command/command.hpp"
#include "command/motion_options.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr auto kHomeParameters = with_motion_options(std::to_array<Parameter>({
    {.name = "method", .help = "number or name in 6098h (default: the present one)", .kind = Kind::value},
    {.name = "--speed", .help = "switch search speed (6099h:01)", .kind = Kind::value},
    {.name = "--search", .help = "speed of the search for zero (6099h:02)", .kind = Kind::value},
    {.name = "--offset", .help = "home offset (607Ch)", .kind = Kind::value},
    {.name = "--within",
     .help = "timeout (default: from --window and speed, else 60s)",
     .kind = Kind::duration},
    kCsvOption,
}));

Result<motion::Home> parse_home(const Arguments& arguments) {
  motion::Home home;
  home.method = arguments.text("method");
  home.fast = arguments.text("--speed");
  home.slow = arguments.text("--search");
  home.offset = arguments.text("--offset");
  const auto longest = duration_option(arguments, "--within");
  if (!longest) return fail(longest.error());
  home.longest = *longest;
  return home;
}

Result<void> check_home(Context& context, const Arguments& arguments) {
  if (const auto home = parse_home(arguments); !home) return fail(home.error());
  using Least = motion::WrittenQuantity::Least;
  return check_motion_words(context, arguments, drive::Use::home,
                            {{.word = "method", .object = objects::kHomingMethod, .least = Least::any},
                             {.word = "--speed", .object = objects::kHomingSpeedSwitch},
                             {.word = "--search", .object = objects::kHomingSpeedZero},
                             {.word = "--offset",
                              .object = objects::kHomeOffset,
                              .kind = motion::MotionUnits::Kind::way,
                              .least = Least::any}});
}

Result<report::Value> run_home(Context& context, const Arguments& arguments) {
  const auto home = parse_home(arguments);
  if (!home) return fail(home.error());
  const auto request = motion_request(context, arguments);
  if (!request) return fail(request.error());
  return motion::run_motion(context, *request,
                            motion::motion_run(*home, motion::plan_home, motion::run_home));
}

constexpr Example kHomeExamples[] = {
    {"home 35 --speed 30rpm --search 5rpm -n 1 -d gsd600 --turn 131072",
     "the present position becomes home; 131072: take your motor's counts a turn"},
    {"home 17 --speed 60rpm --search 10rpm -n 1 -d sv2 --panel PA-20=0,PA-74=1",
     "to the negative limit switch; the panel shows that the drive acts on it"},
};

}  // namespace

extern const Command kHome;
const Command kHome{
    .path = "home",
    .summary = "Find the home position",
    .details =
        "Homing mode with the family's own start sequence, supervised and ended like `jog`. \"Homing "
        "attained\" left from an earlier run does not count: the bits must clear and set again (with a "
        "method that takes the present position, that position must read as the offset). Method, speeds "
        "and offset are restored afterwards; the home position stays.",
    .parameters = kHomeParameters,
    .examples = kHomeExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::moves,
    .run = run_home,
    .check = check_home,
};

}  // namespace servoctl::commands
