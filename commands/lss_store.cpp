#include "canopen/lss.hpp"
#include "command/lss_options.hpp"
#include "session/lss.hpp"
#include "settings/lss_node.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Parameter kLssStoreParameters[] = {
    kVendorOption, kProductOption, kRevisionOption, kSerialOption, kOnlySlaveOption,
};

Result<Value> run_lss_store(Context& context, const Arguments& arguments) {
  const auto choice = lss_choice(context, arguments);
  if (!choice) return fail(choice.error());
  const canopen::LssRequest requests[] = {canopen::lss_store()};
  if (context.dry_run) return lss_planned_frames(*choice, requests);
  if (const auto sure = context.confirm(
          "Store the node-ID and the bitrate of the LSS slave? It starts with them from now on.");
      !sure)
    return fail(sure.error());
  auto& session = *context.session;
  session::LssDialogue lss(session, session.options().timeout);
  const auto slave = lss.select(choice->address);
  if (!slave) return fail(slave.error());
  const auto stored = lss.order(requests[0], "stored its configuration",
                                std::max(session.options().timeout, settings::kLssStorePatience));
  if (!stored) return fail(stored.error());
  if (const auto left = lss.leave(); !left) context.errors.push_back(left.error());
  auto out = lss_identity_record(slave->address);
  out.push_back({"stored", true});
  return Value(std::move(out));
}

Result<void> check_lss_store(Context& context, const Arguments& arguments) {
  return check_lss_choice(context, arguments);
}

constexpr Example kLssStoreExamples[] = {
    {"lss store --only", "node-ID and bitrate of the only slave on the bus"},
    {"lss store -n 5", "those of node 5"},
};

}  // namespace

extern const Command kLssStore;
const Command kLssStore{
    .path = "lss store",
    .summary = "Let an LSS slave keep its node-ID and bitrate; asks first",
    .details =
        "What `lss set-node` and `lss set-bitrate` set is lost with the power unless it is stored, by --keep there or "
        "by this. What is stored is what was set last, also where it is not in force yet. Not every slave can; one "
        "that cannot says so, or does not answer. The slave is named as for `lss inquire`.",
    .parameters = kLssStoreParameters,
    .examples = kLssStoreExamples,
    .needs = Needs::can,
    .effect = Effect::stores,
    .family = FamilyCheck::never,
    .run = run_lss_store,
    .check = check_lss_store,
    .elsewhere = "a drive on EtherCAT is addressed by its place on the ring; `store` keeps its parameters",
};

}  // namespace servoctl::commands
