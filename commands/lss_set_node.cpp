
#include "base/format.hpp"
#include "base/number.hpp"
#include "canopen/node_id.hpp"
#include "command/lss_options.hpp"
#include "command/setting_options.hpp"
#include "settings/address_change.hpp"
#include "settings/lss_node.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using canopen::kUnconfigured;
using report::Value;

constexpr Parameter kLssSetNodeParameters[] = {
    {.name = "new", .help = "the new node-ID, 1 to 127; 255: none", .kind = Kind::number, .required = true},
    kVendorOption,
    kProductOption,
    kRevisionOption,
    kSerialOption,
    kOnlySlaveOption,
    kKeepOption,
};

Result<std::uint8_t> new_node(const Arguments& arguments) {
  const auto number = parse_integer(arguments.text("new"));
  const auto node = number ? number->as_unsigned() : std::nullopt;
  const bool good =
      node && ((*node >= canopen::kFirstNode && *node <= canopen::kLastNode) || *node == kUnconfigured);
  if (!good)
    return fail(Errc::usage, message("'{}' is not a node-ID", as_it_is(arguments.text("new"))),
                "node-IDs are 1 to 127; 255 takes the node-ID away (CiA 305)");
  return static_cast<std::uint8_t>(*node);
}

std::string node_text(std::uint8_t node) {
  return node == kUnconfigured ? std::string("no node-ID") : formatted("node-ID {}", node);
}

std::string question_lss_set_node(session::Session& session, const session::LssSlave& slave,
                                  const settings::LssNodeChange& change) {
  if (settings::has_lss_node(slave, change))
    return formatted("Store {} in the LSS slave with {}? It has it already.", node_text(change.to),
                     to_string(slave.address));
  auto out = formatted("Give {} to the LSS slave with {}?", node_text(change.to), to_string(slave.address));
  if (slave.is_unconfigured()) return out + " It has none, and starts with it.";
  if (!slave.node) return out + " It does not tell which it has; the new one holds when it starts again.";
  out += formatted(
      " It is node {} now; its communication is reset (NMT): unstored PDOs, COB-IDs and heartbeats "
      "are lost, and a moving axis may lose its control.",
      *slave.node);
  if (const auto by = settings::shared_lss_node(session, slave); !by.empty())
    out += formatted(" Another drive has this node-ID too ({}): it hears the reset as well.", by);
  return out;
}

Value node_value(std::optional<std::uint8_t> node) {
  return node && *node != kUnconfigured ? Value(*node) : Value();
}

Value planned_lss_set_node(const LssChoice& choice, const settings::LssNodeChange& change) {
  std::vector<canopen::LssRequest> requests{canopen::lss_set_node(change.to)};
  if (change.keep) requests.push_back(canopen::lss_store());
  return lss_planned_frames(choice, requests);
}

Result<Value> run_lss_set_node(Context& context, const Arguments& arguments) {
  const auto to = new_node(arguments);
  if (!to) return fail(to.error());
  const auto choice = lss_choice(context, arguments);
  if (!choice) return fail(choice.error());
  const settings::LssNodeChange change{choice->address, *to, arguments.has("--keep")};
  if (context.dry_run) {
    context.notices.push_back(
        "a slave that has another node-ID gets an NMT reset of its communication behind these frames");
    return planned_lss_set_node(*choice, change);
  }
  const auto slave = settings::look_at_lss_slave(context, change);
  if (!slave) return fail(slave.error());
  const bool stays = settings::has_lss_node(*slave, change);
  const bool idle = stays && !change.keep;
  if (!stays) context.free_nodes = {change.to};
  auto agreed =
      idle ? Result<void>() : context.confirm(question_lss_set_node(*context.session, *slave, change));
  // It may have been enabled meanwhile.
  if (agreed && !idle && slave->node && !slave->is_unconfigured())
    agreed = settings::refuse_energised(*context.session, *slave->node, "its address");
  if (!agreed) return fail(agreed.error());
  const auto outcome = settings::give_lss_node(context, *slave, change);
  if (outcome.error) context.errors.push_back(*outcome.error);
  auto out = lss_identity_record(slave->address);
  out.push_back({"node", node_value(slave->node)});
  out.push_back({"new_node", node_value(change.to), report::Show::everywhere, "new"});
  out.push_back({"result", outcome.result});
  out.push_back({"kept", outcome.kept ? Value(*outcome.kept) : Value()});
  if (outcome.done && !change.keep && !stays)
    context.notices.push_back(
        "it is not stored: after power-off the slave has what it stored last; `lss store`, or --keep, keeps it");
  return Value(std::move(out));
}

Result<void> check_lss_set_node(Context& context, const Arguments& arguments) {
  if (const auto to = new_node(arguments); !to) return fail(to.error());
  return check_lss_choice(context, arguments);
}

constexpr Example kLssSetNodeExamples[] = {
    {"lss set-node 5 --only --keep", "the only slave on the bus becomes node 5, and stores it"},
    {"lss set-node 5 -n 3 --keep", "node 3 becomes node 5"},
};

}  // namespace

extern const Command kLssSetNode;
const Command kLssSetNode{
    .path = "lss set-node",
    .summary = "Give an LSS slave a node-ID; asks first",
    .details =
        "The slave is named as for `lss inquire`: by its identity (--vendor, --product, --revision, "
        "--serial), by -n, or by --only. A slave without a node-ID starts with the new one at once; of one "
        "that has another node-ID the communication is reset (NMT), and an energised drive is left alone, as is one "
        "whose number an energised one has. A "
        "node-ID that somebody uses is refused: all that answer, are heard within 1.5 s, or answer node guarding, which starts life guarding where 100Ch and 100Dh are set. At "
        "the end the slave is looked for by its new node-ID and its 1018h. --keep stores it; where that "
        "fails the old node-ID is set again. 255 takes the node-ID away.",
    .parameters = kLssSetNodeParameters,
    .examples = kLssSetNodeExamples,
    .needs = Needs::can,
    .effect = Effect::resets,
    .family = FamilyCheck::never,
    .run = run_lss_set_node,
    .check = check_lss_set_node,
    .elsewhere = "a drive on EtherCAT is addressed by its place on the ring; it has no node-ID to change",
};

}  // namespace servoctl::commands
