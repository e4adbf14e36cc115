#include "command/command.hpp"
#include "command/motion_options.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr auto kMoveParameters = with_motion_options(std::to_array<Parameter>({
    {.name = "target",
     .help = "90deg, 2rev, 1000inc (the drive's own counts), or 20mm where the cabinet file tells the load",
     .kind = Kind::value,
     .required = true},
    {.name = "--relative", .help = "relative to the actual position", .kind = Kind::flag},
    {.name = "--speed",
     .help = "speed of the move (default: a fifth of the speed limit)",
     .kind = Kind::value},
    kAccelerationOption,
    kCsvOption,
}));

Result<report::Value> run_move(Context& context, const Arguments& arguments) {
  motion::Move move;
  move.target = arguments.text("target");
  move.relative = arguments.has("--relative");
  move.speed = arguments.text("--speed");
  const auto request = motion_request(context, arguments);
  if (!request) return fail(request.error());
  return motion::run_motion(context, *request, motion::motion_run(move, motion::plan_move, motion::run_move));
}

Result<void> check_move(Context& context, const Arguments& arguments) {
  const auto* profile = context.profile;
  const auto speed = profile == nullptr ? Result<drive::Target>(drive::Target{})
                                        : drive::resolve(profile, profile->rules.motion.position_speed);
  return check_motion_words(context, arguments, drive::Use::move,
                            {{.word = "target",
                              .object = objects::kTargetPosition,
                              .kind = motion::MotionUnits::Kind::way,
                              .least = motion::WrittenQuantity::Least::any},
                             {.word = "--speed", .object = speed ? speed->address : ObjectAddress{}}});
}

constexpr Example kMoveExamples[] = {
    {"move 90deg --relative --speed 30rpm -n 1 -d sv2", "a quarter turn from here"},
    {"move 2rev --speed 60rpm --window 3rev -n 1 -d ts --turn 10000",
     "3 turns at most; 10000 counts a turn: take your motor's"},
    {"move lift 20mm --relative --speed 10mm/s", "an axis whose load the cabinet file tells"},
};

}  // namespace

extern const Command kMove;
const Command kMove{
    .path = "move",
    .summary = "Go to a position",
    .details =
        "Profile position mode, with the set-point handshake where the family has it (else 607Ah is followed at "
        "once), supervised and ended like `jog`. The move is "
        "done when the drive reports target reached, is at standstill, and is at the target position; a "
        "distance that the drive's counts cannot represent to 1 % is refused. Afterwards the drive is "
        "disabled: the motor does not hold its position.",
    .parameters = kMoveParameters,
    .examples = kMoveExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::moves,
    .run = run_move,
    .check = check_move,
};

}  // namespace servoctl::commands
