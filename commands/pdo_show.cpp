#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "pdo/pdo_record.hpp"
#include "session/pdo_setup.hpp"
#include "show/pdo_report.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using canopen::Pdo;
using canopen::PdoDirection;
using report::List;
using report::Record;
using report::Show;
using report::Value;
using session::Values;

/// The PDOs of one node.
struct NodePdos {
  std::uint8_t node = 0;
  Values values;
  std::vector<Pdo> pdos;
  std::vector<std::uint16_t> assigned;
  Values factory;  ///< Empty without a profile.
};

/// A field that is not as the drive left the factory.
struct PdoDifference {
  std::string_view key;
  std::string factory;  ///< What it was there, in words.
};

bool differs(const Values& present, const Values& factory, ObjectAddress object) {
  const auto now = present.find(object);
  const auto then = factory.find(object);
  return now != present.end() && then != factory.end() && now->second != then->second;
}

bool mapping_differs(const Values& present, const Values& factory, const Pdo& pdo) {
  bool out = differs(present, factory, {pdo.mapping_index(), 0});
  for (std::size_t sub = 1; sub <= pdo.entries.size(); ++sub)
    out = out || differs(present, factory, {pdo.mapping_index(), static_cast<std::uint8_t>(sub)});
  return out;
}

std::string factory_mapping(const Context& context, const Pdo& factory) {
  std::string out;
  for (const auto& entry : factory.entries)
    append(out, show::mapped_name(context.profile, entry, context.chinese));
  return out.empty() ? "nothing mapped" : out;
}

std::vector<PdoDifference> differences(const Context& context, const NodePdos& node, const Pdo& pdo) {
  const auto all = session::pdos_of(node.factory);
  const auto same = [&](const Pdo& f) { return f.direction == pdo.direction && f.number == pdo.number; };
  const auto found = std::find_if(all.begin(), all.end(), same);
  if (found == all.end()) return {};
  const auto& factory = *found;
  const auto other = [&](std::uint8_t sub) {
    return differs(node.values, node.factory, {pdo.communication_index(), sub});
  };
  std::vector<PdoDifference> out;
  if (other(1))
    out.push_back({"cob_id", formatted("{} {}", show::can_id_text(factory, node.node),
                                       factory.is_valid() ? "valid" : "not valid")});
  if (other(2)) out.push_back({"type", formatted("type {}", factory.type)});
  if (other(3))
    out.push_back({"inhibit_ms", "inhibit time " + show::inhibit_text(factory.inhibit.value_or(0))});
  if (other(5)) out.push_back({"event_ms", formatted("event timer {} ms", factory.event.value_or(0))});
  if (other(6)) out.push_back({"sync_start", formatted("SYNC start {}", factory.sync_start.value_or(0))});
  if (mapping_differs(node.values, node.factory, pdo))
    out.push_back({"entries", factory_mapping(context, factory)});
  return out;
}

/// What speaks against this PDO beside the others of the nodes asked.
std::vector<std::string> conflicts(const NodePdos& mine, const Pdo& pdo, const std::vector<NodePdos>& all) {
  std::vector<std::string> out;
  if (!pdo.is_valid()) return out;
  const auto text = show::can_id_text(pdo.cob_id);
  if (const auto service = canopen::service_of(pdo.can_id()); !service.empty())
    out.push_back(formatted("{} is reserved for {}", text, service));
  const bool sent = pdo.direction == PdoDirection::transmit;
  for (const auto& node : all)
    for (const auto& other : node.pdos) {
      const bool same =
          node.node == mine.node && other.direction == pdo.direction && other.number == pdo.number;
      if (same || !other.is_valid() || other.can_id() != pdo.can_id()) continue;
      const auto name = canopen::name(other.direction, other.number);
      if (sent && other.direction == PdoDirection::transmit)
        out.push_back(formatted("{} of node {} is also sent with {}", name, node.node, text));
      if (sent && other.direction == PdoDirection::receive)
        out.push_back(formatted("{} of node {} receives it", name, node.node));
      if (!sent && other.direction == PdoDirection::receive)
        out.push_back(formatted("{} of node {} also receives {}", name, node.node, text));
    }
  return out;
}

Record node_record(const Context& context, const NodePdos& mine, const std::vector<NodePdos>& all) {
  Record out{{"node", mine.node}};
  List pdos;
  for (const auto& pdo : mine.pdos) {
    const auto name = canopen::name(pdo.direction, pdo.number);
    const bool assigned = std::count(mine.assigned.begin(), mine.assigned.end(), pdo.mapping_index()) > 0;
    auto record = show::pdo_record(context.profile, pdo, mine.node, context.chinese);
    const bool has_cob_ids = context.session == nullptr || !context.session->network().is_ring();
    auto lines = show::pdo_lines(context.profile, pdo, mine.node, context.chinese, has_cob_ids);
    if (assigned) lines.front() += ", assigned";
    List differing;
    std::string factory;
    for (const auto& difference : differences(context, mine, pdo)) {
      differing.emplace_back(difference.key);
      factory += (factory.empty() ? "from the factory: " : "; ") + difference.factory;
    }
    List clashes;
    for (auto& conflict : conflicts(mine, pdo, all)) {
      lines.push_back("conflict: " + conflict);
      clashes.emplace_back(std::move(conflict));
    }
    if (!factory.empty()) lines.push_back(std::move(factory));
    for (std::size_t i = 0; i < lines.size(); ++i)
      out.push_back({i == 0 ? name : std::string(), std::move(lines[i]), Show::text});
    record.push_back({"assigned", assigned});
    record.push_back({"differs", std::move(differing)});
    record.push_back({"conflicts", std::move(clashes)});
    pdos.emplace_back(std::move(record));
  }
  out.push_back({"pdos", std::move(pdos), Show::json});
  return out;
}

Result<Value> run_pdo_show(Context& context, const Arguments&) {
  const auto read = session::read_pdo_values(*context.session, context.profile, context.nodes);
  pdo::tell_cut_off_changes(context);
  std::vector<NodePdos> all;
  for (std::size_t i = 0; i < read.size(); ++i) {
    if (!read[i]) {
      context.errors.push_back(read[i].error());
      continue;
    }
    NodePdos node{context.nodes[i], *read[i], session::pdos_of(*read[i]), {}, {}};
    if (context.profile != nullptr) node.factory = session::default_pdo_values(*context.profile, node.node);
    if (node.pdos.empty())
      context.notices.push_back(
          message("node {} has no PDO parameters that can be read", node_name(node.node)));
    node.assigned = session::assigned_pdos(context.profile, node.values);
    all.push_back(std::move(node));
  }
  List out;
  for (const auto& node : all) out.emplace_back(node_record(context, node, all));
  return Value(std::move(out));
}

constexpr Example kPdoShowExamples[] = {
    {"pdo show -n 1 -d gsd600", "all that are in use, and what differs from the factory"},
    {"pdo show -n all", "also two drives with the same COB-ID"},
};

}  // namespace

extern const Command kPdoShow;
const Command kPdoShow{
    .path = "pdo show",
    .summary = "Show what a drive sends and receives as PDOs",
    .details =
        "All RPDOs (received by the drive) and TPDOs (sent): COB-ID, transmission type, times, mapped "
        "objects; with -d, also what differs from the factory setting. With -n all, also TPDOs of two drives "
        "with the same COB-ID.",
    .parameters = {},
    .examples = kPdoShowExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run_pdo_show,
};

}  // namespace servoctl::commands
