#include "show/ring_table.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "session/scan.hpp"
#include "show/identity.hpp"

namespace servoctl::show {
namespace {

using ethercat::PortLook;
using report::Hex;
using report::Record;
using report::Show;
using report::Value;
using session::RingSlave;

constexpr std::size_t kMostNodes = 127;

/// Without leading zeros: the row has to fit a line of 80 columns.
Value hex(const std::optional<std::uint32_t>& number) { return number ? Value(Hex{*number, 1}) : Value(); }

std::string name_of(const RingSlave& slave) {
  if (!slave.identity.device_name.empty()) return slave.identity.device_name;
  if (!slave.seen.sii) return {};
  return slave.seen.sii->name.empty() ? slave.seen.sii->order : slave.seen.sii->name;
}

std::vector<session::Guess> guesses_of(const RingSlave& slave, std::span<const drive::Family> families) {
  return slave.has_objects ? session::guess_families(slave.identity, families)
                           : session::guess_by_sii(slave.identity, families);
}

std::string short_guess(std::span<const session::Guess> guesses) {
  std::vector<session::Guess> own;
  std::copy_if(guesses.begin(), guesses.end(), std::back_inserter(own),
               [](const auto& g) { return !g.generic; });
  return guess_text(own.empty() ? guesses : own);
}

/// The ports with a cable and somebody at its other end: `0 1`.
std::string linked_ports(const ethercat::SlaveLook& look) {
  std::string out;
  for (std::size_t port = 0; port < look.ports.size(); ++port)
    if (look.ports[port].link) append(out, formatted("{}", port), " ");
  return out;
}

report::List port_records(const ethercat::SlaveLook& look) {
  report::List out;
  for (std::size_t port = 0; port < look.ports.size(); ++port) {
    const auto& p = look.ports[port];
    out.emplace_back(Record{{"port", port},
                            {"link", p.link},
                            {"open", p.open},
                            {"signal", p.signal},
                            {"bad_frames", p.bad_frames},
                            {"bad_symbols", p.bad_symbols},
                            {"forwarded", p.forwarded},
                            {"lost_links", p.lost_links}});
  }
  return out;
}

report::List texts(const std::vector<std::string>& lines) {
  report::List out;
  for (const auto& line : lines) out.emplace_back(line);
  return out;
}

report::List guesses_of_slave(std::span<const session::Guess> guesses) {
  report::List out;
  for (const auto& guess : guesses)
    out.emplace_back(Record{{"family", guess.family}, {"certain", guess.certain}});
  return out;
}

Value coe_of(const RingSlave& slave) {
  if (!slave.seen.sii || slave.seen.sii->is_empty()) return {};
  return (slave.seen.sii->protocols & ethercat::kProtocolCoe) != 0;
}

/// A counter that stands at its end may have counted more.
void count(std::string& out, unsigned number, std::string_view one, std::string_view many) {
  constexpr unsigned kEnd = 255;
  if (number > 0)
    append(out, formatted("{}{} {}", number, number == kEnd ? " or more" : "", number == 1 ? one : many));
}

std::string port_text(const PortLook& port) {
  std::string out;
  count(out, port.bad_frames, "bad frame", "bad frames");
  count(out, port.bad_symbols, "bad symbol", "bad symbols");
  count(out, port.forwarded, "frame marked bad by another slave", "frames marked bad by other slaves");
  count(out, port.lost_links, "lost link", "lost links");
  if (port.link && !port.open) append(out, "a link, but closed: frames do not go out there");
  return out;
}

void note_wire(std::vector<std::string>& out, std::uint8_t node, const ethercat::SlaveLook& look) {
  for (std::size_t port = 0; port < look.ports.size(); ++port)
    if (const auto text = port_text(look.ports[port]); !text.empty())
      out.push_back(formatted("node {}: port {}: {}", node, port, text));
  std::string text;
  count(text, look.bad_commands, "frame it could not process", "frames it could not process");
  count(text, look.pdi_errors, "error of its own processor's access", "errors of its own processor's access");
  if (!text.empty()) out.push_back(formatted("node {}: {}", node, text));
}

}  // namespace

std::string al_text(const ethercat::AlStatus& al) {
  if (!al.error) return std::string(name(al.state));
  return formatted("{}, error 0x{:04X} {}", name(al.state), al.code, ethercat::al_status_text(al.code));
}

Record al_fields(const ethercat::AlStatus& al) {
  return {{"al_state", name(al.state), Show::json},
          {"al_error", al.error, Show::json},
          {"al_code", al.code, Show::json},
          {"al_text", al.error ? Value(ethercat::al_status_text(al.code)) : Value(), Show::json}};
}

Record no_al_fields() {
  Record out;
  for (const auto* key : {"al_state", "al_error", "al_code", "al_text"}) out.push_back({key, {}, Show::json});
  return out;
}

report::Table ring_table(const Desk& desk, const session::RingScan& ring, std::span<const std::uint8_t> nodes,
                         std::span<const Condition> conditions, std::span<const drive::Family> families,
                         bool in_full) {
  const auto full = in_full ? Show::everywhere : Show::json;
  report::Table table;
  table.columns = {{"node"},
                   {"station", "", Show::text},
                   {"station", "", Show::json},
                   {"alias", "", Show::text},
                   {"alias", "", Show::json},
                   {"vendor_id", "vendor", full},
                   {"product_code", "product", full},
                   {"revision", "rev", full},
                   {"serial", "", full},
                   {"name"},
                   {"state", "AL state", Show::text},
                   {"links", "ports", Show::text},
                   {"guess", "family", Show::text},
                   {"al_state", "", Show::json},
                   {"al_error", "", Show::json},
                   {"al_code", "", Show::json},
                   {"al_text", "", Show::json},
                   {"foreign", "", Show::json},
                   {"ports", "", Show::json},
                   {"bad_commands", "", Show::json},
                   {"pdi_errors", "", Show::json},
                   {"coe", "", Show::json},
                   {"sii_doubts", "", Show::json},
                   {"device_type", "", Show::json},
                   {"device_name", "", Show::json},
                   {"hardware_version", "", Show::json},
                   {"software_version", "", Show::json},
                   {"families", "", Show::json}};
  add_condition_columns(in_full, table);
  table.json_only = nodes.empty();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto node = nodes[i];
    const auto& slave = ring.slaves[node - 1U];
    const auto& look = slave.seen.look;
    const auto& identity = slave.identity;
    const auto guesses = guesses_of(slave, families);
    auto state = std::string(name(look.al.state)) + (look.al.error ? " error" : "");
    report::List row{node,
                     look.station != 0 ? Value(Hex{look.station, 4}) : Value(),
                     look.station,
                     look.alias != 0 ? Value(Hex{look.alias, 4}) : Value(),
                     look.alias,
                     hex(identity.vendor_id),
                     hex(identity.product_code),
                     hex(identity.revision),
                     hex(identity.serial),
                     report::text_or_null(name_of(slave)),
                     std::move(state),
                     report::text_or_null(linked_ports(look)),
                     report::text_or_null(short_guess(guesses))};
    for (auto& field : al_fields(look.al)) row.push_back(std::move(field.value));
    for (auto& value : report::List{
             slave.seen.foreign, port_records(look), look.bad_commands, look.pdi_errors, coe_of(slave),
             texts(slave.doubts), hex(identity.device_type), report::text_or_null(identity.device_name),
             report::text_or_null(identity.hardware_version), report::text_or_null(identity.software_version),
             guesses_of_slave(guesses)})
      row.push_back(std::move(value));
    add_condition(desk, conditions[i], in_full, row);
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<std::string> ring_notices(const session::RingScan& ring, std::span<const std::uint8_t> nodes) {
  std::vector<std::string> out;
  if (const auto node = ring.foreign(); node != 0)
    out.push_back(formatted(
        "another master works with this ring: node {} is in {}. It was only looked at; no SII and no object was read",
        node, name(ring.slaves[node - 1U].seen.look.al.state)));
  if (ring.count > kMostNodes)
    out.push_back(formatted("{} slaves are on the ring: those behind position {} have no node number",
                            ring.count, kMostNodes));
  for (const auto node : nodes) {
    const auto& slave = ring.slaves[node - 1U];
    const auto& al = slave.seen.look.al;
    if (al.error) {
      const auto hint = ethercat::al_status_hint(al.code);
      out.push_back(formatted("node {}: {}{}{}", node, al_text(al), hint.empty() ? "" : "; ", hint));
    }
    for (const auto& doubt : slave.doubts) out.push_back(formatted("node {}: SII: {}", node, doubt));
    note_wire(out, node, slave.seen.look);
  }
  return out;
}

}  // namespace servoctl::show
