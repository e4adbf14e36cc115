#include "cabinet/axis_identity.hpp"
#include "command/lss_options.hpp"
#include "session/can_network.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kLssSelectParameters[] = {
    kVendorOption, kProductOption, kRevisionOption, kSerialOption, kOnlySlaveOption,
};

Result<report::Value> run_lss_select(Context& context, const Arguments& arguments) {
  const auto choice = lss_choice(context, arguments);
  if (!choice) return fail(choice.error());
  // The lines after it mean the drive of the axis.
  for (const auto* axis : context.axes) {
    session::Identity identity;
    identity.node = axis->node;
    if (choice->address) identity.serial = choice->address->serial;
    if (const auto same = cabinet::hold_serial(*axis, identity); choice->address && !same)
      return fail(same.error());
  }
  return look_at_lss_slave(context, *choice, [&context](const canopen::LssAddress& address) {
    context.session->can()->lss_selection() = address;
  });
}

Result<void> check_lss_select(Context& context, const Arguments& arguments) {
  return check_lss_choice(context, arguments);
}

constexpr Example kLssSelectExamples[] = {
    {"lss select --only", "at the prompt: then `lss set-node 5` and `lss store`"},
    {"lss select -n 3", "the one that is node 3"},
};

}  // namespace

extern const Command kLssSelect;
const Command kLssSelect{
    .path = "lss select",
    .summary = "Choose the LSS slave that the next lss lines mean",
    .details =
        "Asks the slave what it is, as `lss inquire` does, and keeps its identity: lines of `lss` on this bus that "
        "name no slave mean it from then on, and say so, until another is selected or the bus is left. At the prompt "
        "and in lines from a pipe; a line of a batch file names its slave itself, so that it can be checked before. "
        "Each line selects the slave anew on the bus and takes it back to waiting (CiA 305, switch state selective "
        "and global): none is left in the configuration state meanwhile.",
    .parameters = kLssSelectParameters,
    .examples = kLssSelectExamples,
    .needs = Needs::can,
    .effect = Effect::reads,
    .family = FamilyCheck::never,
    .run = run_lss_select,
    .check = check_lss_select,
    .elsewhere = "a drive on EtherCAT is addressed by its place on the ring: `scan` shows what each is",
};

}  // namespace servoctl::commands
