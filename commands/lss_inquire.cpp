#include "command/lss_options.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kLssInquireParameters[] = {
    kVendorOption, kProductOption, kRevisionOption, kSerialOption, kOnlySlaveOption,
};

Result<report::Value> run_lss_inquire(Context& context, const Arguments& arguments) {
  const auto choice = lss_choice(context, arguments);
  if (!choice) return fail(choice.error());
  return look_at_lss_slave(context, *choice);
}

Result<void> check_lss_inquire(Context& context, const Arguments& arguments) {
  return check_lss_choice(context, arguments);
}

constexpr Example kLssInquireExamples[] = {
    {"lss inquire --only", "the only slave with LSS on the bus"},
    {"lss inquire -n 3", "the one that is node 3"},
};

}  // namespace

extern const Command kLssInquire;
const Command kLssInquire{
    .path = "lss inquire",
    .summary = "Ask one LSS slave what it is, and for its node-ID",
    .details =
        "LSS (CiA 305) speaks to a device before it has a node-ID, or whatever node-ID it has: by its "
        "identity, the four numbers of 1018h. Name the slave by --vendor, --product, --revision and "
        "--serial, by -n where it answers SDO (its 1018h is read), or by --only where it is the only one "
        "with LSS on the bus: two that answer are noticed, and nothing is believed of either. Where none of these is "
        "typed, it is the one of `lss select`. The slave is "
        "taken to the configuration state, asked, and taken back to waiting, on every way out. Many drives "
        "have no LSS: see `address`.",
    .parameters = kLssInquireParameters,
    .examples = kLssInquireExamples,
    .needs = Needs::can,
    .effect = Effect::reads,
    .family = FamilyCheck::never,
    .run = run_lss_inquire,
    .check = check_lss_inquire,
    .elsewhere = "a drive on EtherCAT is addressed by its place on the ring: `scan` shows what each is",
};

}  // namespace servoctl::commands
