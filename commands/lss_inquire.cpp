#include "canopen/lss.hpp"
#include "command/lss_options.hpp"
#include "session/lss.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using canopen::LssService;
using report::Value;

constexpr Parameter kLssInquireParameters[] = {
    kVendorOption, kProductOption, kRevisionOption, kSerialOption, kOnlySlaveOption,
};

Value planned_lss_inquire(const LssChoice& choice) {
  std::vector<canopen::LssRequest> requests;
  for (const auto what : {LssService::inquire_node, LssService::inquire_vendor, LssService::inquire_product,
                          LssService::inquire_revision, LssService::inquire_serial})
    requests.push_back(canopen::lss_inquire(what));
  return lss_planned_frames(choice, requests);
}

Result<Value> run_lss_inquire(Context& context, const Arguments& arguments) {
  const auto choice = lss_choice(context, arguments);
  if (!choice) return fail(choice.error());
  if (context.dry_run) return planned_lss_inquire(*choice);
  session::LssDialogue lss(*context.session, context.session->options().timeout);
  const auto slave = lss.select(choice->address);
  if (!slave) return fail(slave.error());
  if (const auto left = lss.leave(); !left) context.errors.push_back(left.error());
  auto out = lss_identity_record(slave->address);
  const bool has_node = slave->node && !slave->is_unconfigured();
  out.push_back({"node", has_node ? Value(*slave->node) : Value()});
  out.push_back({"configured", slave->node ? Value(has_node) : Value()});
  return Value(std::move(out));
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
        "with LSS on the bus: two that answer are noticed, and nothing is believed of either. The slave is "
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
