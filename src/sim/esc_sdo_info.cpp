#include "sim/esc_sdo_info.hpp"

#include <algorithm>

#include "canopen/sdo_abort.hpp"

namespace servoctl::sim {
namespace abort_code = canopen::sdo_abort;

namespace {

enum Operation : std::uint8_t {
  kListRequest = 1,
  kList,
  kObjectRequest,
  kObject,
  kEntryRequest,
  kEntry,
  kError,
};
constexpr std::uint8_t kIncomplete = 0x80;
constexpr std::size_t kInfoHead = 4;
/// Lists: 0 the length of each, then all, for RxPDOs, for TxPDOs, kept, set at the start.
enum Kind : std::uint16_t { kLengths, kAll, kReceive, kTransmit, kBackup, kSettings };
/// What an entry description has beside its type.
constexpr unsigned kDefault = 0x10;
constexpr unsigned kMinimum = 0x20;
constexpr unsigned kMaximum = 0x40;

void add(Bytes& out, std::uint64_t value, std::size_t size) {
  const auto bytes = store_le(value, size);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

bool is_kept(const od::Entry& entry) {
  return entry.access == od::Access::rw && !entry.command && !entry.is_volatile;
}

bool is_of(const od::Object& object, std::uint16_t kind) {
  const auto any = [&](auto has) { return std::any_of(object.entries.begin(), object.entries.end(), has); };
  switch (kind) {
    case kAll: return true;
    case kReceive:
      return any(
          [](const auto& e) { return e.pdo == od::PdoMapping::rpdo || e.pdo == od::PdoMapping::both; });
    case kTransmit:
      return any(
          [](const auto& e) { return e.pdo == od::PdoMapping::tpdo || e.pdo == od::PdoMapping::both; });
    case kBackup: return any(is_kept);
    case kSettings: return any(is_kept) && object.index < 0x6000;
    default: return false;
  }
}

/// Bits 0 to 2: read in PRE-OP, SAFE-OP, OP; 3 to 5: written; 6, 7: in an RxPDO, in a TxPDO; 8: kept.
std::uint16_t access_of(const od::Entry& entry) {
  constexpr unsigned kRead = 0x07;
  constexpr unsigned kWrite = 0x38;
  constexpr unsigned kWriteInPreOp = 0x08;
  constexpr unsigned kInReceive = 0x40;
  constexpr unsigned kInTransmit = 0x80;
  constexpr unsigned kKept = 0x100;
  const auto index = entry.address.index;
  const bool assigns = index >= 0x1600 && index < 0x1D00;
  unsigned out = od::readable(entry.access) ? kRead : 0U;
  if (od::writable(entry.access)) out |= assigns ? kWriteInPreOp : kWrite;
  if (entry.pdo == od::PdoMapping::rpdo || entry.pdo == od::PdoMapping::both) out |= kInReceive;
  if (entry.pdo == od::PdoMapping::tpdo || entry.pdo == od::PdoMapping::both) out |= kInTransmit;
  if (is_kept(entry)) out |= kKept;
  return static_cast<std::uint16_t>(out);
}

}  // namespace

std::vector<Bytes> EscSdoInfo::on_request(ByteSpan request, std::size_t most) const {
  auto done = answer(request);
  if (done.abort != 0) {
    done.operation = kError;
    done.data = store_le(done.abort, 4);
  }
  const auto room = most - kInfoHead;
  const auto pieces = std::max<std::size_t>((done.data.size() + room - 1) / room, 1);
  std::vector<Bytes> out;
  for (std::size_t i = 0; i < pieces; ++i) {
    const auto left = pieces - 1 - i;
    Bytes piece{static_cast<std::uint8_t>(done.operation | (left != 0 ? kIncomplete : 0U)), 0};
    add(piece, left, 2);
    const auto begin = done.data.begin() + static_cast<std::ptrdiff_t>(i * room);
    const auto size = std::min(room, done.data.size() - i * room);
    piece.insert(piece.end(), begin, begin + static_cast<std::ptrdiff_t>(size));
    out.push_back(std::move(piece));
  }
  return out;
}

EscSdoInfo::Answer EscSdoInfo::answer(ByteSpan request) const {
  const auto word = static_cast<std::uint16_t>(load_le(request.subspan(kInfoHead, 2)));
  switch (request[0] & 0x7FU) {
    case kListRequest: return list(word);
    case kObjectRequest: return describe_object(word);
    case kEntryRequest: return describe_entry(request.subspan(kInfoHead));
    default: return {kError, {}, abort_code::kCommand};
  }
}

EscSdoInfo::Answer EscSdoInfo::list(std::uint16_t kind) const {
  if (kind > kSettings) return {kError, {}, abort_code::kRange};
  Answer out{kList};
  add(out.data, kind, 2);
  if (kind == kLengths) {
    const auto lengths = count_lists();
    out.data.insert(out.data.end(), lengths.begin(), lengths.end());
    return out;
  }
  for (const auto& object : profile_->dictionary.objects())
    if (is_of(object, kind)) add(out.data, object.index, 2);
  return out;
}

Bytes EscSdoInfo::count_lists() const {
  Bytes out;
  const auto objects = profile_->dictionary.objects();
  for (const std::uint16_t kind : {kAll, kReceive, kTransmit, kBackup, kSettings}) {
    const auto count =
        std::count_if(objects.begin(), objects.end(), [kind](const auto& o) { return is_of(o, kind); });
    add(out, static_cast<std::uint64_t>(count), 2);
  }
  return out;
}

EscSdoInfo::Answer EscSdoInfo::describe_object(std::uint16_t index) const {
  const auto* object = profile_->dictionary.object(index);
  if (object == nullptr || object->entries.empty()) return {kError, {}, abort_code::kNoObject};
  const bool one_type = object->code != od::ObjectCode::record;
  Answer out{kObject};
  add(out.data, index, 2);
  add(out.data, one_type ? od::cia_code(object->entries.back().type) : 0U, 2);
  add(out.data, object->entries.back().address.sub, 1);
  add(out.data, static_cast<std::uint64_t>(object->code), 1);
  out.data.insert(out.data.end(), object->name.begin(), object->name.end());
  return out;
}

EscSdoInfo::Answer EscSdoInfo::describe_entry(ByteSpan request) const {
  constexpr std::size_t kSize = 4;
  if (request.size() < kSize) return {kError, {}, abort_code::kGeneral};
  const ObjectAddress address{static_cast<std::uint16_t>(load_le(request.first(2))), request[2]};
  const auto* entry = profile_->dictionary.find(address);
  if (entry == nullptr) {
    const bool known = profile_->dictionary.object(address.index) != nullptr;
    return {kError, {}, known ? abort_code::kNoSubIndex : abort_code::kNoObject};
  }
  unsigned info = 0;
  Bytes values;
  const auto add_value = [&](unsigned flag, const std::optional<od::NodeValue>& value) {
    if ((request[3] & flag) == 0 || !value) return;
    const auto bytes = od::encode(entry->type, value->for_node(node_));
    if (!bytes) return;
    info |= flag;
    values.insert(values.end(), bytes->begin(), bytes->end());
  };
  add_value(kDefault, entry->default_value);
  add_value(kMinimum, entry->low);
  add_value(kMaximum, entry->high);
  Answer out{kEntry};
  add(out.data, address.index, 2);
  add(out.data, address.sub, 1);
  add(out.data, info, 1);
  add(out.data, od::cia_code(entry->type), 2);
  add(out.data, od::size_of(entry->type).value_or(0) * 8, 2);
  add(out.data, access_of(*entry), 2);
  out.data.insert(out.data.end(), values.begin(), values.end());
  out.data.insert(out.data.end(), entry->name.begin(), entry->name.end());
  return out;
}

}  // namespace servoctl::sim
