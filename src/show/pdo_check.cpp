#include "show/pdo_check.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/naming.hpp"
#include "session/cob_id_check.hpp"
#include "show/pdo_report.hpp"

namespace servoctl::show {
namespace {

using canopen::Pdo;
using canopen::PdoDirection;
using canopen::PdoEntry;

/// Lengths of the data types 0001h to 0007h, which stand for gaps (CiA 301, 7.4.8.2).
constexpr std::uint8_t kGapBits[] = {0, 1, 8, 16, 32, 8, 16, 32};
/// Bits of a COB-ID that hold a CAN-ID of 11 bits.
constexpr std::uint32_t kBasicCanId = 0x7FF;

std::string name_of(const Pdo& pdo) { return canopen::name(pdo.direction, pdo.number); }

std::string name_of(const drive::Profile& profile, ObjectAddress object) {
  const auto label = drive::target_at(&profile, object).label();
  return label.empty() ? to_string(object) : formatted("{} ({})", to_string(object), label);
}

tl::unexpected<Error> no(const Pdo& pdo, const Message& why, Message hint = {}) {
  return fail(Errc::usage, message("{}: {}", name_of(pdo), why), std::move(hint));
}

/// What the data says of it; doubts left aside.
bool fits_direction(const od::Entry& entry, PdoDirection direction) {
  const auto wanted = direction == PdoDirection::receive ? od::PdoMapping::rpdo : od::PdoMapping::tpdo;
  if (entry.pdo != wanted && entry.pdo != od::PdoMapping::both) return false;
  return direction == PdoDirection::receive ? od::writable(entry.access) : od::readable(entry.access);
}

std::string direction_hint(const od::Entry& entry) {
  switch (entry.pdo) {
    case od::PdoMapping::no: return "this drive cannot map it into a PDO";
    case od::PdoMapping::rpdo: return "it can be mapped only into an RPDO";
    case od::PdoMapping::tpdo: return "it can be mapped only into a TPDO";
    case od::PdoMapping::both: return "it is read-only";
  }
  return {};
}

Result<void> check_entry(const drive::Profile& profile, const Pdo& pdo, const PdoEntry& entry) {
  if (entry.is_gap()) {
    if (pdo.direction == PdoDirection::receive) return {};
    return no(pdo, "only an RPDO has gaps");
  }
  const auto name = name_of(profile, entry.object);
  const auto* known = profile.dictionary.find(entry.object);
  if (known == nullptr) {
    if (profile.is_generic()) return {};
    return no(pdo,
              message("{} is not in the dictionary of {}", to_string(entry.object), as_it_is(profile.family)),
              message("`objects -d {}` lists what it has", as_it_is(profile.family)));
  }
  if (!may_map(*known, pdo.direction))
    return no(pdo, name + " cannot be mapped here", direction_hint(*known));
  const auto bits = bits_of(profile, entry.object);
  const bool sure = !profile.is_generic() && !known->doubts.about("type");
  if (bits && sure && *bits != entry.bits)
    return no(pdo, message("{} has {} bits, not {}", name, *bits, entry.bits));
  if (profile.rules.pdo.whole_bytes && entry.bits % 8 != 0)
    return no(pdo, message("{}: {} bits are not whole bytes", name, entry.bits),
              "this drive maps bytes only");
  return {};
}

bool is_fixed(const drive::Profile& profile, const Pdo& pdo) {
  const auto* count = profile.dictionary.find({pdo.mapping_index(), 0});
  return count != nullptr && !od::writable(count->access);
}

/// The transmission types that this PDO of the drive takes.
std::string types_text(const drive::Profile& profile, const Pdo& pdo) {
  if (pdo.direction == PdoDirection::receive) return "0 to 240 at the next SYNC, 254 and 255 at once";
  const auto& refused = profile.rules.pdo.refused_types;
  std::string out = "0 to 240 by SYNC";
  const auto add = [&](std::uint8_t first, std::string_view how) {
    std::string types;
    for (const std::uint8_t type : {first, static_cast<std::uint8_t>(first + 1)})
      if (std::count(refused.begin(), refused.end(), type) == 0) append(types, fmt::to_string(type), " and ");
    if (!types.empty()) out += formatted(", {} by {}", types, how);
  };
  if ((pdo.cob_id & canopen::kPdoNoRtr) == 0) add(252, "remote frame");
  add(254, "event");
  return out;
}

Result<void> check_type(const drive::Profile& profile, const Pdo& pdo) {
  const auto& refused = profile.rules.pdo.refused_types;
  const bool reserved = pdo.type > 240 && pdo.type < 252;
  const bool remote = pdo.type == 252 || pdo.type == 253;
  const bool transmit = pdo.direction == PdoDirection::transmit;
  if (reserved || (remote && !transmit))
    return no(pdo, message("there is no transmission type {}", pdo.type), types_text(profile, pdo));
  if (transmit && std::count(refused.begin(), refused.end(), pdo.type) > 0)
    return no(pdo, message("this drive does not support transmission type {}", pdo.type),
              types_text(profile, pdo));
  return {};
}

/// A drive refuses to be asked by what its COB-ID forbids (CiA 301, table 71).
Result<void> check_remote(const drive::Profile& profile, const Pdo& wanted) {
  const bool remote = wanted.type == 252 || wanted.type == 253;
  const bool forbidden = (wanted.cob_id & canopen::kPdoNoRtr) != 0;
  if (wanted.direction != PdoDirection::transmit || !remote || !forbidden) return {};
  return no(wanted,
            message("transmission type {} is sent on remote frames, which bit 30 of its COB-ID forbids",
                    wanted.type),
            types_text(profile, wanted));
}

Result<void> check_bits(const drive::Profile& profile, const Pdo& present, const Pdo& wanted) {
  const auto may_change = profile.rules.pdo.cob_id_bits | canopen::kPdoInvalid;
  if (((present.cob_id ^ wanted.cob_id) & ~may_change) == 0) return {};
  const bool other_id = (may_change & kBasicCanId) != 0;
  if (other_id && (wanted.cob_id & canopen::kPdoExtended) != 0)
    return no(wanted,
              message("this drive has 11-bit CAN-IDs, {} is a 29-bit one", can_id_text(wanted.cob_id)),
              "write one up to 0x7FF");
  return no(wanted, message("this drive has the fixed COB-ID {}", can_id_text(present.cob_id)),
            "it can only be enabled and disabled");
}

Result<void> check_can_id(const Pdo& wanted, std::span<const Pdo> all) {
  const auto text = can_id_text(wanted.cob_id);
  const auto cob_id = store_le(wanted.cob_id, 4);
  if (const auto may = session::check_cob_id(nullptr, {wanted.communication_index(), 1}, cob_id, 0); !may)
    return no(wanted, may.error().message, may.error().hint);
  for (const auto& other : all) {
    const bool same = other.direction == wanted.direction && other.number == wanted.number;
    if (!same && other.is_valid() && other.can_id() == wanted.can_id())
      return no(wanted, message("CAN-ID {} is used by {} of the same node", text, name_of(other)),
                message("`pdo disable {}` frees it", as_it_is(name_of(other))));
  }
  return {};
}

}  // namespace

bool may_map(const od::Entry& entry, PdoDirection direction) {
  return entry.doubts.about("pdo") || fits_direction(entry, direction);
}

std::optional<std::uint8_t> bits_of(const drive::Profile& profile, ObjectAddress object) {
  if (object.index < std::size(kGapBits)) return kGapBits[object.index];
  const auto* entry = profile.dictionary.find(object);
  if (entry == nullptr) return std::nullopt;
  if (entry->type == od::DataType::boolean) return std::uint8_t{1};
  const auto size = od::size_of(entry->type);
  return size && *size <= 8 ? std::optional(static_cast<std::uint8_t>(*size * 8)) : std::nullopt;
}

Result<void> check_mapping(const drive::Profile& profile, const Pdo& pdo) {
  const auto& rules = profile.rules.pdo;
  if (is_fixed(profile, pdo))
    return no(pdo, message("its mapping 0x{:04X} is fixed", pdo.mapping_index()),
              "`pdo enable` selects it, `pdo show` lists what it carries");
  if (pdo.entries.size() > rules.most_entries)
    return no(pdo, message("{} objects are too many, {} fit", pdo.entries.size(), rules.most_entries));
  for (const auto& entry : pdo.entries)
    if (const auto fits = check_entry(profile, pdo, entry); !fits) return fits;
  if (pdo.bits() > rules.most_bits)
    return no(pdo, message("{} bits are too many, {} fit", pdo.bits(), rules.most_bits),
              "spread the objects over two PDOs");
  return {};
}

Result<void> check_communication(const drive::Profile& profile, const Pdo& present, const Pdo& wanted,
                                 std::span<const Pdo> all) {
  if (const auto may = check_bits(profile, present, wanted); !may) return may;
  if (wanted.is_valid() && wanted.cob_id != present.cob_id)
    if (const auto free = check_can_id(wanted, all); !free) return free;
  const auto missing = [&](bool now, bool then, std::string_view what) {
    return then && !now ? Result<void>(no(wanted, message("it has no {} on this drive", what)))
                        : Result<void>();
  };
  if (const auto r = missing(present.inhibit.has_value(), wanted.inhibit.has_value(), "inhibit time"); !r)
    return r;
  if (const auto r = missing(present.event.has_value(), wanted.event.has_value(), "event timer"); !r)
    return r;
  if (const auto r =
          missing(present.sync_start.has_value(), wanted.sync_start.has_value(), "SYNC start value");
      !r)
    return r;
  if (wanted.type == present.type) return {};
  if (const auto known = check_type(profile, wanted); !known) return known;
  return check_remote(profile, wanted);
}

}  // namespace servoctl::show
