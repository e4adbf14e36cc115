#include "session/scan.hpp"
#include "base/format.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include "canopen/node_list.hpp"
#include "command/command.hpp"
#include "drive/bitrate.hpp"
#include "drive/standard_objects.hpp"
#include "session/adapter_link.hpp"
#include "session/answer.hpp"
#include "session/bitrate_search.hpp"
#include "session/identify.hpp"
#include "session/modbus_network.hpp"
#include "session/own_bitrate.hpp"
#include "session/ring_scan.hpp"
#include "show/bitrate_scan.hpp"
#include "show/identity.hpp"
#include "show/registers.hpp"
#include "show/ring_table.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kScanParameters[] = {
    {.name = "--long", .help = "the identity in numbers, instead of the drives' state", .kind = Kind::flag},
    {.name = "--all-bitrates",
     .help = "ask at each bitrate in turn, where nobody talks; asks first",
     .kind = Kind::flag},
};

/// All at the same time; what a node refuses, or no longer answers, it does not tell.
std::vector<show::Condition> conditions_of(session::Session& session, std::span<const std::uint8_t> nodes) {
  std::vector<session::SdoRequest> requests;
  for (const auto node : nodes)
    for (const auto object : {objects::kStatusword, objects::kErrorCode})
      requests.push_back({.node = node, .object = object, .size = 2});
  const auto answers = session.transfer(requests);
  const auto word = [&](std::size_t i) -> std::optional<std::uint16_t> {
    const auto number = session::number_in(answers[i], 2);
    return number ? std::optional(static_cast<std::uint16_t>(*number)) : std::nullopt;
  };
  std::vector<show::Condition> out;
  for (std::size_t i = 0; i < answers.size(); i += 2) out.push_back({word(i), word(i + 1)});
  return out;
}

/// Of a ring: of those whose objects were read; in the order of `nodes`.
std::vector<show::Condition> conditions_of(session::Session& session, const session::RingScan& ring,
                                           std::span<const std::uint8_t> nodes) {
  std::vector<std::uint8_t> open;
  for (const auto node : nodes)
    if (ring.slaves[node - 1U].has_objects) open.push_back(node);
  auto told = conditions_of(session, open);
  std::vector<show::Condition> out;
  for (std::size_t i = 0, k = 0; i < nodes.size(); ++i)
    out.push_back(ring.slaves[nodes[i] - 1U].has_objects ? told[k++] : show::Condition{});
  return out;
}

/// A ring is looked at as a whole; those that were named are shown.
Result<report::Value> run_ring(Context& context, session::EtherCatNetwork& network, bool in_full) {
  const auto ring = session::scan_ring(*context.session, network);
  if (!ring) return fail(ring.error());
  std::vector<std::uint8_t> nodes;
  const bool all = !context.nodes_typed || context.nodes.empty() || context.nodes.front() == 0;
  for (std::size_t node = 1; all && node <= ring->slaves.size(); ++node)
    nodes.push_back(static_cast<std::uint8_t>(node));
  for (const auto node : all ? std::vector<std::uint8_t>() : context.nodes) {
    if (node <= ring->slaves.size())
      nodes.push_back(node);
    else
      context.errors.push_back(drive_error(Errc::timeout, node, "there is no slave at this position",
                                           message("slaves on the ring: {}", ring->count)));
  }
  for (auto& notice : show::ring_notices(*ring, nodes)) context.notices.push_back(std::move(notice));
  const auto conditions = conditions_of(*context.session, *ring, nodes);
  const bool any_told =
      std::any_of(conditions.begin(), conditions.end(), [](const auto& c) { return c.statusword; });
  return report::Value(show::ring_table(context, *ring, nodes, conditions,
                                        drive::find_families(context.drive_folders), in_full || !any_told));
}

/// All addresses in turn, or those that were named.
Result<report::Value> scan_registers(Context& context) {
  const bool all = !context.nodes_typed || context.nodes.empty() || context.nodes.front() == 0;
  const auto nodes = all ? canopen::every_node_id() : context.nodes;
  if (all) {
    const auto patience =
        std::min(context.session->options().timeout, context.session->modbus()->scan_patience());
    context.tell(
        formatted("{} addresses are asked one after the other, which takes up to {:.0f} s; -n 1-10 asks "
                  "these alone\n",
                  nodes.size(), std::ceil(std::chrono::duration<double>(patience * nodes.size()).count())));
  }
  const auto found = session::scan(*context.session, nodes);
  if (!found) return fail(found.error());
  if (!found->empty()) return report::Value(show::register_scan(context, *found));
  return fail(Errc::timeout, "no unit answered on " + context.session->url(),
              context.session->network().silence_hint(nodes.front()));
}

report::Value planned_bitrates() {
  report::Table table;
  table.columns = {{"bitrate", "", report::Show::json}, {"bitrate_text", "bitrate", report::Show::text}};
  for (const auto bitrate : session::usual_bitrates())
    table.rows.push_back({bitrate, drive::bitrate_text(bitrate)});
  return report::Value(std::move(table));
}

Result<report::Value> run_scan(Context& context, const Arguments& arguments) {
  const bool all_bitrates = arguments.has("--all-bitrates");
  if (auto* ring = context.session->ethercat(); ring != nullptr && !all_bitrates)
    return run_ring(context, *ring, arguments.has("--long"));
  if (context.session->modbus() != nullptr && !all_bitrates) return scan_registers(context);
  auto nodes = context.nodes_typed ? context.nodes : std::vector<std::uint8_t>();
  if (nodes.empty() || nodes.front() == 0) nodes = canopen::every_node_id();
  if (all_bitrates && context.dry_run) return planned_bitrates();
  // The interface is put back, or left where nodes answered, on every way out.
  const auto hold = context.session->protect(all_bitrates ? session::Care::unsettled : session::Care::none);
  const auto named = all_bitrates ? std::make_unique<session::NamedBitrate>(*context.session) : nullptr;
  const auto families = drive::find_families(context.drive_folders);
  const auto warn = show::warn_of_details(context, families);
  auto found = all_bitrates ? show::scan_all_bitrates(context, nodes, warn)
                            : session::scan(*context.session, nodes, nullptr, warn);
  if (!found) return fail(found.error());
  if (found->empty()) {
    context.errors.push_back(make_error(
        Errc::timeout, "no node answered on " + context.session->url(),
        "check power, cable, 120 ohm at both ends, and that the interface has the drives' bitrate; a stopped "
        "node does not answer: `nmt preop -n all`"));
  }
  session::look_for_families(*context.session, *found, families);
  std::vector<std::uint8_t> there;
  for (const auto& node : *found) there.push_back(node.node);
  return report::Value(show::identity_table(context, *found, conditions_of(*context.session, there), families,
                                            arguments.has("--long")));
}

Result<void> check_scan(Context& context, const Arguments& arguments) {
  const auto url = context.front_end == nullptr ? std::string_view() : context.front_end->bus_url();
  if (!arguments.has("--all-bitrates") || url.empty()) return {};
  return session::check_own_bitrate(url, "scan --all-bitrates");
}

constexpr Example kScanExamples[] = {
    {"scan -b can0", "who is on the bus: family and state of each node"},
    {"scan --long -n 1-10 -b can0", "the identity in numbers, of these nodes only"},
    {"scan -b coe:eth0", "the ring: name, AL state and links of each slave"},
};

}  // namespace

extern const Command kScan;
const Command kScan{
    .path = "scan",
    .summary = "Find the nodes on the bus: what they are, and how",
    .details =
        "Reads object 1000h of nodes 1 to 127, or of the --node in the line itself, all at the same time: "
        "the scan takes one timeout however many there are. Families are identified by the identity and, "
        "where that is not enough, by reading two or three objects that only they have; `?` marks an "
        "unproven guess. cia402 fits every drive of that profile: it is listed where nothing else fits, and "
        "always by `info` and in JSON. The state is that of the drive by its statusword, the NMT state that of the "
        "heartbeat where one came meanwhile; --long shows the numbers of the identity instead, JSON has "
        "both. --all-bitrates asks at each bitrate until nodes answer, for a bus on which nobody talks: it listens at the "
        "present bitrate first and refuses when it hears anything (`bus detect` finds that bitrate without sending). "
        "It asks before, and needs --yes in a script; the interface stays at the bitrate where nodes answered, and is "
        "put back to the one it had where none did. An adapter behind slcan: is put back in any case, to the bitrate "
        "in the name of its bus; which name it needs from then on is told. On EtherCAT, shows the ring: for each position (its node number) the "
        "address, name by the SII, AL state, ports with a link and, as notices, every error counter that is not "
        "0; of slaves in PRE-OP and above that servoctl has numbered also the drive's state and fault (`status -n "
        "all` takes the others there). Nothing is changed: no state is entered, no address given, and a ring that "
        "another master works with is only looked at. On Modbus, asks the addresses 1 to 127 one after the other; with -d "
        "FAMILY it shows the alarm of each that answers: registers do not say what a device is.",
    .parameters = kScanParameters,
    .examples = kScanExamples,
    .needs = Needs::bus,
    .effect = Effect::links,
    .reads_without = "--all-bitrates",
    .run = run_scan,
    .check = check_scan,
    .on_registers = true,
};

}  // namespace servoctl::commands
