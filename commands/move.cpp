#include "command/command.hpp"
#include "command/motion_options.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr auto kParameters = with_motion_options(std::to_array<Parameter>({
    {.name = "target",
     .help = "90deg, 2rev, or the drive's own counts",
     .kind = Kind::value,
     .required = true},
    {.name = "--relative", .help = "counted from where it stands", .kind = Kind::flag},
    {.name = "--speed",
     .help = "speed of the move (a fifth of the safe speed unless said)",
     .kind = Kind::value},
    kAccelerationOption,
    kCsvOption,
}));

Result<report::Value> run(Context& context, const Arguments& arguments) {
  motion::Move move;
  move.target = arguments.text("target");
  move.relative = arguments.has("--relative");
  move.speed = arguments.text("--speed");
  const auto request = motion_request(context, arguments);
  if (!request) return fail(request.error());
  return motion::run_motion(context, *request, motion::motion_run(move, motion::plan_move, motion::run_move));
}

}  // namespace

extern const Command kMove;
const Command kMove{
    .path = "move",
    .summary = "Go to a position",
    .details =
        "Profile position with the set-point handshake, watched and ended like `jog`. The motion counts as "
        "done when the drive reports the target reached, stands still, and is where it was sent; a way that "
        "the drive's counts cannot say to 1 % is refused. Afterwards it is without power and holds nothing. "
        "Example: `move 90deg --speed 30rpm -n 1`.",
    .parameters = kParameters,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::moves,
    .run = run,
};

}  // namespace servoctl::commands
