#include "command/command.hpp"
#include "command/motion_options.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr auto kTorqueParameters = with_motion_options(std::to_array<Parameter>({
    {.name = "torque", .help = "5%, 0.2Nm; the sign is the direction", .kind = Kind::value, .required = true},
    {.name = "--for", .help = "how long", .kind = Kind::duration, .required = true},
    kCsvOption,
}));

Result<motion::Torque> parse_torque(const Arguments& arguments) {
  if (!arguments.has("--limit"))
    return fail(Errc::usage, "an unloaded motor runs away in torque mode: a speed limit is needed",
                "add --limit 60rpm");
  motion::Torque torque;
  torque.torque = arguments.text("torque");
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  if (!*length) return fail(Errc::usage, "how long?", "add --for 1s");
  torque.length = **length;
  return torque;
}

Result<void> check_torque_words(Context& context, const Arguments& arguments) {
  if (const auto torque = parse_torque(arguments); !torque) return fail(torque.error());
  return check_motion_words(context, arguments, drive::Use::torque,
                            {{.word = "torque",
                              .object = objects::kTargetTorque,
                              .kind = motion::MotionUnits::Kind::way,
                              .least = motion::WrittenQuantity::Least::any}});
}

Result<report::Value> run_torque(Context& context, const Arguments& arguments) {
  const auto torque = parse_torque(arguments);
  if (!torque) return fail(torque.error());
  const auto request = motion_request(context, arguments);
  if (!request) return fail(request.error());
  return motion::run_motion(context, *request,
                            motion::motion_run(*torque, motion::plan_torque, motion::run_torque));
}

constexpr Example kTorqueExamples[] = {
    {"torque 5% --for 1s --limit 60rpm -n 1 -d sv2",
     "5 % of the rated torque for a second, stopped above 1.2 times 60 rpm"},
    {"torque -0.2Nm --for 500ms --limit 30rpm -n 1 -d dm", "in newton metres, backwards"},
};

}  // namespace

extern const Command kTorque;
const Command kTorque{
    .path = "torque",
    .summary = "Apply a torque for a time",
    .details =
        "Torque mode, supervised and ended like `jog`. --limit is the speed limit: it is set in the drive "
        "where the family has one for this mode, and servoctl always stops a motor that exceeds 1.2 times "
        "it. Above the rated torque --max-torque is needed; above 6072h is refused.",
    .parameters = kTorqueParameters,
    .examples = kTorqueExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::moves,
    .run = run_torque,
    .check = check_torque_words,
};

}  // namespace servoctl::commands
