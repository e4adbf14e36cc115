// How PDOs, mapped objects and CAN-IDs are written on the command line.

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/naming.hpp"
#include "pdo/pdo_changing.hpp"
#include "session/cob_id_check.hpp"
#include "session/pdo_setup.hpp"
#include "show/pdo_check.hpp"

namespace servoctl::pdo {
namespace {

using canopen::Pdo;
using canopen::PdoEntry;

/// The data type that stands for a gap of so many bits (CiA 301, 7.4.8.2).
std::optional<std::uint16_t> gap_of(std::uint64_t bits) {
  switch (bits) {
    case 1: return std::uint16_t{0x0001};
    case 8: return std::uint16_t{0x0005};
    case 16: return std::uint16_t{0x0006};
    case 32: return std::uint16_t{0x0007};
    default: return std::nullopt;
  }
}

constexpr std::string_view kNodeId = "$NODEID+";

}  // namespace

Result<PdoEntry> parse_mapped(const drive::Profile& profile, std::string_view text) {
  if (starts_with_nocase(text, "gap")) {
    const auto bits = parse_digits(text.substr(3), 10);
    const auto type = bits ? gap_of(*bits) : std::nullopt;
    if (type) return PdoEntry{{*type, 0}, static_cast<std::uint8_t>(*bits)};
  }
  const auto slash = text.rfind('/');
  const auto target = drive::resolve(&profile, text.substr(0, slash));
  if (!target) return fail(target.error());
  if (slash != std::string_view::npos) {
    const auto bits = parse_digits(text.substr(slash + 1), 10);
    if (!bits || *bits == 0 || *bits > 64)
      return fail(Errc::usage,
                  message("'{}': after the / comes the number of bits, 1 to 64", as_it_is(text)));
    return PdoEntry{target->address, static_cast<std::uint8_t>(*bits)};
  }
  const auto bits = show::bits_of(profile, target->address);
  if (!bits && !profile.is_generic() && profile.dictionary.find(target->address) == nullptr)
    return fail(
        Errc::usage,
        message("{} is not in the dictionary of {}", to_string(target->address), as_it_is(profile.family)),
        message("`objects -d {}` lists what can be mapped", as_it_is(profile.family)));
  if (!bits || *bits == 0)
    return fail(Errc::usage, message("the length of {} is not known", as_it_is(text)),
                message("give its bits: {}/16", to_string(target->address)));
  return PdoEntry{target->address, *bits};
}

Result<std::uint32_t> parse_can_id(std::string_view text, std::uint8_t node) {
  const bool plus_node = starts_with_nocase(text, kNodeId);
  const auto number = parse_integer(plus_node ? text.substr(kNodeId.size()) : text);
  const auto value = number ? number->as_unsigned() : std::nullopt;
  const auto can_id = value.value_or(0) + (plus_node ? node : 0U);
  if (!value || *value > canopen::kPdoCobIdMask || can_id > canopen::kPdoCobIdMask)
    return fail(Errc::usage, message("'{}' is not a CAN-ID for a PDO", as_it_is(text)),
                "write a number up to 0x7FF, or $NODEID+0x180; 29 bits: up to 0x1FFFFFFF");
  const bool extended = can_id > 0x7FF || (starts_with_nocase(text, "0x") && text.size() == 10);
  return static_cast<std::uint32_t>(can_id) | (extended ? canopen::kPdoExtended : 0U);
}

Result<std::uint32_t> parse_pdo_can_id(std::string_view text, std::uint8_t node) {
  const auto can_id = parse_can_id(text, node);
  if (!can_id) return can_id;
  if (const auto free =
          session::check_cob_id(nullptr, {Pdo{}.communication_index(), 1}, store_le(*can_id, 4), 0);
      !free)
    return fail(free.error());
  return can_id;
}

Result<void> switch_on(Pdo& pdo, std::uint8_t node) {
  pdo.cob_id &= ~canopen::kPdoInvalid;
  if ((pdo.cob_id & canopen::kPdoCobIdMask) != 0) return {};
  if (pdo.number > 4)
    return fail(Errc::usage, message("{} has no CAN-ID yet", canopen::name(pdo.direction, pdo.number)),
                "give one: `pdo map … --cob-id 0x3A0`");
  const auto first = pdo.direction == canopen::PdoDirection::receive ? 0x200U : 0x180U;
  pdo.cob_id |= first + 0x100U * (pdo.number - 1U) + node;
  return {};
}

Result<void> assign_pdo(const drive::Profile& profile, const PresentPdos& present, const Pdo& pdo, bool add,
                        session::Values& out) {
  const auto list = session::assignment_of(&profile, pdo.direction);
  const auto name = canopen::name(pdo.direction, pdo.number);
  if (!list || present.values.count(*list) == 0)
    return fail(Errc::usage, name + " has no COB-ID, and nothing assigns it");
  auto merged = present.values;
  for (const auto& [object, data] : out) merged.insert_or_assign(object, data);
  std::vector<std::uint16_t> records;
  for (const auto record : session::assigned_pdos(&profile, merged)) {
    const auto place = canopen::pdo_at(record);
    if (place && place->direction == pdo.direction && record != pdo.mapping_index())
      records.push_back(record);
  }
  if (add) records.push_back(pdo.mapping_index());
  const auto* object = profile.dictionary.object(list->index);
  const std::size_t room = object == nullptr ? 0 : object->entries.back().address.sub;
  if (records.size() > room)
    return fail(Errc::usage, message("{} cannot be assigned in addition: there is room for {}", name, room),
                "`pdo show` lists what is assigned; `pdo disable` one first");
  out.insert_or_assign(*list, store_le(records.size(), 1));
  for (std::size_t i = 0; i < records.size(); ++i)
    out.insert_or_assign({list->index, static_cast<std::uint8_t>(i + 1)}, store_le(records[i], 2));
  return {};
}

}  // namespace servoctl::pdo
