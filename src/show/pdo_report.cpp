#include "show/pdo_report.hpp"

#include "base/format.hpp"
#include "drive/naming.hpp"

namespace servoctl::show {
namespace {

using canopen::Pdo;
using canopen::PdoDirection;
using report::Hex;
using report::Record;
using report::Value;

std::string ordinal(unsigned number) {
  const bool teens = number % 100 / 10 == 1;
  const auto last = teens ? 0 : number % 10;
  return formatted("{}{}", number, last == 1 ? "st" : last == 2 ? "nd" : last == 3 ? "rd" : "th");
}

std::string sent_text(unsigned type) {
  if (type == 0) return "at the SYNC after a change";
  if (type == 1) return "at every SYNC";
  if (type <= 240) return formatted("at every {} SYNC", ordinal(type));
  if (type == 252) return "on a remote frame, with the values of the last SYNC";
  if (type == 253) return "on a remote frame";
  if (type >= 254) return "by event";
  return "reserved";
}

std::string taken_text(unsigned type) {
  if (type <= 240) return "taken over at the next SYNC";
  return type >= 254 ? "taken over at once" : "reserved";
}

/// The node-ID in a CAN-ID of the pre-defined connection set, or 0.
std::uint32_t base_of(std::uint32_t can_id, std::uint8_t node) {
  return can_id > 0x7F && can_id <= 0x7FF && (can_id & 0x7FU) == node ? can_id - node : 0;
}

double inhibit_ms(std::uint16_t inhibit) { return inhibit / 10.0; }

template <class T>
Value or_null(const std::optional<T>& value) {
  return value ? Value(*value) : Value();
}

/// A PDO that has no COB-ID at all stands in no communication record.
bool has_can_id(const Pdo& pdo) { return (pdo.cob_id & canopen::kPdoCobIdMask) != 0; }

}  // namespace

std::string transmission_text(const drive::Profile* profile, PdoDirection direction, std::uint8_t type) {
  if (direction == PdoDirection::receive) return taken_text(type);
  if (profile != nullptr) {
    const auto& types = profile->rules.pdo.types;
    if (const auto found = types.find(type); found != types.end()) return found->second;
  }
  return sent_text(type);
}

std::string mapped_name(const drive::Profile* profile, canopen::PdoEntry entry, bool chinese) {
  if (entry.is_gap()) return "gap";
  const auto target = drive::target_at(profile, entry.object);
  auto name = chinese ? target.label_zh() : target.label();
  return name.empty() ? to_string(entry.object) : name;
}

std::string can_id_text(std::uint32_t cob_id) {
  const auto can_id = cob_id & canopen::kPdoCobIdMask;
  return (cob_id & canopen::kPdoExtended) != 0 ? formatted("0x{:08X}", can_id)
                                               : formatted("0x{:03X}", can_id);
}

std::string can_id_text(const Pdo& pdo, std::uint8_t node) {
  const auto base = base_of(pdo.can_id(), node);
  return base == 0 ? can_id_text(pdo.cob_id)
                   : formatted("{} ($NODEID+0x{:X})", can_id_text(pdo.cob_id), base);
}

std::string inhibit_text(std::uint16_t inhibit) { return formatted("{:g} ms", inhibit_ms(inhibit)); }

Record pdo_record(const drive::Profile* profile, const Pdo& pdo, std::uint8_t node, bool chinese) {
  const auto can_id = pdo.cob_id & canopen::kPdoCobIdMask;
  const auto base = base_of(pdo.can_id(), node);
  report::List entries;
  for (const auto& entry : pdo.entries)
    entries.emplace_back(Record{{"index", entry.object.index},
                                {"sub", entry.object.sub},
                                {"bits", entry.bits},
                                {"name", mapped_name(profile, entry, chinese)}});
  const bool linked = has_can_id(pdo);
  return {{"pdo", canopen::name(pdo.direction, pdo.number)},
          {"direction", pdo.direction == PdoDirection::receive ? "rpdo" : "tpdo"},
          {"number", pdo.number},
          {"communication_index", pdo.communication_index()},
          {"mapping_index", pdo.mapping_index()},
          {"cob_id", linked ? Value(pdo.cob_id) : Value()},
          {"can_id", linked ? Value(can_id) : Value()},
          {"node_id_base", base == 0 ? Value() : Value(base)},
          {"valid", pdo.is_valid()},
          {"type", linked ? Value(pdo.type) : Value()},
          {"type_text", linked ? Value(transmission_text(profile, pdo.direction, pdo.type)) : Value()},
          {"inhibit_ms", pdo.inhibit ? Value(inhibit_ms(*pdo.inhibit)) : Value()},
          {"event_ms", or_null(pdo.event)},
          {"sync_start", or_null(pdo.sync_start)},
          {"bits", pdo.bits()},
          {"entries", std::move(entries)}};
}

std::vector<std::string> pdo_lines(const drive::Profile* profile, const Pdo& pdo, std::uint8_t node,
                                   bool chinese, bool has_cob_ids) {
  auto communication = formatted("{}mapping 0x{:04X}", has_cob_ids ? "no COB-ID, " : "", pdo.mapping_index());
  if (has_can_id(pdo)) {
    communication =
        formatted("{} {}, {} (type {})", can_id_text(pdo, node), pdo.is_valid() ? "valid" : "not valid",
                  transmission_text(profile, pdo.direction, pdo.type), pdo.type);
    if (pdo.inhibit.value_or(0) != 0) communication += ", at most every " + inhibit_text(*pdo.inhibit);
    if (pdo.event.value_or(0) != 0) communication += formatted(", event timer {} ms", *pdo.event);
    if (pdo.sync_start.value_or(0) != 0) communication += formatted(", from SYNC {} on", *pdo.sync_start);
  }
  std::string mapping = pdo.entries.empty() ? "nothing mapped" : formatted("{} of 64 bits:", pdo.bits());
  if (!has_can_id(pdo) && !pdo.entries.empty()) mapping = formatted("{} bytes:", pdo.bits() / 8);
  for (std::size_t i = 0; i < pdo.entries.size(); ++i)
    mapping += formatted("{} {} ({})", i == 0 ? "" : ",", mapped_name(profile, pdo.entries[i], chinese),
                         pdo.entries[i].bits);
  return {std::move(communication), std::move(mapping)};
}

}  // namespace servoctl::show
