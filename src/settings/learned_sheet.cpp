#include "settings/learned_sheet.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <span>

#include "base/format.hpp"
#include "base/pdo_index.hpp"
#include "drive/cia402.hpp"
#include "drive/learned_access.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::settings {
namespace {

constexpr std::uint16_t kProfileFirst = 0x6000;

bool is_text(const Bytes& bytes) {
  const auto end = std::find(bytes.begin(), bytes.end(), std::uint8_t{0});
  const bool rest_is_zero = std::all_of(end, bytes.end(), [](std::uint8_t c) { return c == 0; });
  return end - bytes.begin() > 3 && rest_is_zero &&
         std::all_of(bytes.begin(), end, [](std::uint8_t c) { return c >= 0x20 && c < 0x7F; });
}

od::DataType type_of(const session::ScannedEntry& entry) {
  constexpr od::DataType kBySize[] = {od::DataType::u8,  od::DataType::u16, od::DataType::u24,
                                      od::DataType::u32, od::DataType::u40, od::DataType::u48,
                                      od::DataType::u56, od::DataType::u64};
  if (!entry.readable) return od::DataType::u32;
  if (entry.size > 4 && is_text(entry.begin)) return od::DataType::string;
  if (entry.size >= 1 && entry.size <= std::size(kBySize)) return kBySize[entry.size - 1];
  return entry.size == 0 ? od::DataType::string : od::DataType::bytes;
}

/// The type of the standard, or the one of its kind with the size that was read.
std::optional<od::DataType> type_like(const session::ScannedEntry& entry, od::DataType type,
                                      bool sizes_unknown) {
  const auto size = od::size_of(type);
  const bool is_text_type = type == od::DataType::string && entry.size <= 4;
  if (!entry.readable || (size && *size == entry.size) ||
      (!size && (type != od::DataType::string || is_text_type || type_of(entry) == od::DataType::string)))
    return type;
  if (sizes_unknown && size && *size < entry.size && entry.size == 4) return type;
  if (!od::is_integer(type) || entry.size == 0 || entry.size > 8) return std::nullopt;
  constexpr od::DataType kSigned[] = {od::DataType::i8,  od::DataType::i16, od::DataType::i24,
                                      od::DataType::i32, od::DataType::i40, od::DataType::i48,
                                      od::DataType::i56, od::DataType::i64};
  return od::is_signed(type) ? kSigned[entry.size - 1] : type_of(entry);
}

/// The number of the axis that has this index (CiA 402-2).
unsigned axis_of(std::uint16_t index) {
  unsigned axis = 1;
  while (axis < drive::kMostAxes && index >= drive::of_axis({kProfileFirst, 0}, axis + 1).index) ++axis;
  return axis;
}

/// `Axis 2: Statusword` where the object is one of a further axis.
std::string with_axis(std::uint16_t index, const std::string& name) {
  const auto axis = axis_of(index);
  return axis == 1 ? name : formatted("Axis {}: {}", axis, name);
}

/// CAN-IDs without the node-ID that the predefined connection set has for this COB-ID (CiA 301, 7.3.5).
std::span<const std::uint32_t> predefined_bases(ObjectAddress object) {
  static constexpr std::uint32_t kEmergency[] = {0x080};
  static constexpr std::uint32_t kRequest[] = {0x600};
  static constexpr std::uint32_t kResponse[] = {0x580};
  static constexpr std::uint32_t kRpdo[] = {0x200, 0x300, 0x400, 0x500};
  static constexpr std::uint32_t kTpdo[] = {0x180, 0x280, 0x380, 0x480};
  if (object == objects::kEmergencyCobId) return kEmergency;
  if (object == ObjectAddress{0x1200, 1}) return kRequest;
  if (object == ObjectAddress{0x1200, 2}) return kResponse;
  const auto place = pdo_at(object.index);
  if (!place || place->mapping || object.sub != 1) return {};
  return place->direction == PdoDirection::transmit ? std::span<const std::uint32_t>(kTpdo) : kRpdo;
}

/// The COB-ID without the node-ID, with its other bits, if it follows the node-ID.
std::optional<std::uint32_t> predefined_base(const session::ScannedEntry& entry, std::uint8_t node) {
  constexpr std::uint32_t kExtended = 1U << 29U;
  if (entry.size != 4 || entry.begin.size() != 4) return std::nullopt;
  const auto cob_id = static_cast<std::uint32_t>(load_le(entry.begin));
  const auto can_id = cob_id & (kExtended - 1);
  const auto bases = predefined_bases(entry.object);
  const bool follows = (cob_id & kExtended) == 0 && std::any_of(bases.begin(), bases.end(), [&](auto base) {
                         return base + node == can_id;
                       });
  return follows ? std::optional(cob_id - node) : std::nullopt;
}

class SheetMaker {
 public:
  SheetMaker(const session::ScanState& state, const session::Identity& identity,
             const od::Dictionary* standard)
      : state_(&state), identity_(&identity), standard_(standard), sizes_unknown_(answers_four_bytes()) {
    for (const auto& entry : state.entries) {
      const auto place = pdo_at(entry.object.index);
      if (place && place->mapping && entry.object.sub != 0 && entry.begin.size() == 4) {
        const auto mapped = static_cast<std::uint32_t>(load_le(entry.begin));
        mapped_.insert({static_cast<std::uint16_t>(mapped >> 16U), static_cast<std::uint8_t>(mapped >> 8U)});
      }
    }
  }

  od::EdsFile make() {
    od::EdsFile out;
    auto entries = state_->entries;
    std::stable_sort(entries.begin(), entries.end(),
                     [](const auto& a, const auto& b) { return a.object < b.object; });
    for (auto at = entries.begin(); at != entries.end();) {
      const auto end = std::find_if(at, entries.end(),
                                    [&](const auto& each) { return each.object.index != at->object.index; });
      out.dictionary.add(object_of({at, end}));
      at = end;
    }
    describe(out);
    return out;
  }

 private:
  /// What the standard says of an index; of an axis only where the drive has it.
  const od::Object* standard_object(std::uint16_t index) const {
    if (standard_ == nullptr) return nullptr;
    const auto axis = axis_of(index);
    const auto statusword = drive::of_axis(objects::kStatusword, axis);
    const bool has_axis = std::any_of(state_->entries.begin(), state_->entries.end(),
                                      [&](const auto& each) { return each.object == statusword; });
    const bool is_drive = axis == 1 && drive::is_drive_type(identity_->device_type.value_or(0));
    return drive::standard_object(*standard_, index, has_axis || is_drive);
  }

  const od::Entry* standard_entry(ObjectAddress address) const {
    const auto* object = standard_object(address.index);
    if (object == nullptr) return nullptr;
    for (const auto& each : object->entries)
      if (each.address.sub == address.sub) return &each;
    return nullptr;
  }

  /// Some drives answer with four bytes whatever the object has: then nothing shorter is ever read.
  bool answers_four_bytes() const {
    std::size_t longer = 0;
    for (const auto& entry : state_->entries) {
      if (entry.readable && entry.size < 4) return false;
      const auto* known = standard_entry(entry.object);
      const auto size = known == nullptr ? std::nullopt : od::size_of(known->type);
      if (entry.readable && entry.size == 4 && size && *size < 4) ++longer;
    }
    return longer > 1;
  }

  od::Object object_of(std::span<const session::ScannedEntry> entries) {
    const auto index = entries.front().object.index;
    const auto* known = standard_object(index);
    od::Object out;
    out.index = index;
    out.name = known != nullptr ? with_axis(index, known->name) : formatted("Object {:04X}h", index);
    const bool one = entries.size() == 1 && entries.front().object.sub == 0;
    const bool is_array = known != nullptr && known->code == od::ObjectCode::array;
    const bool is_record = known != nullptr && known->code == od::ObjectCode::record;
    const bool is_var = one && !is_array && !is_record;
    out.code = is_var ? od::ObjectCode::var : is_array ? od::ObjectCode::array : od::ObjectCode::record;
    for (const auto& entry : entries)
      out.entries.push_back(entry_of(entry, standard_entry(entry.object), is_var ? out.name : std::string()));
    if (is_var) out.name = out.entries.front().name;
    if (!is_var) set_count(out, entries);
    return out;
  }

  od::Entry entry_of(const session::ScannedEntry& entry, const od::Entry* known, const std::string& name) {
    od::Entry out;
    out.address = entry.object;
    const auto like = known == nullptr ? std::nullopt : type_like(entry, known->type, sizes_unknown_);
    const bool fits = like && (od::readable(known->access) || !entry.readable);
    out.name = !name.empty()      ? name
               : known != nullptr ? known->name
                                  : formatted("Sub-index {}", entry.object.sub);
    if (!fits && (!entry.readable || (sizes_unknown_ && entry.size == 4))) out.name += " (size unknown)";
    out.type = fits ? *like : type_of(entry);
    out.access = !entry.readable ? od::Access::wo : fits ? known->access : od::Access::ro;
    out.pdo = fits ? known->pdo : od::PdoMapping::no;
    if (out.pdo == od::PdoMapping::no && mapped_.contains(entry.object)) out.pdo = od::PdoMapping::both;
    if (entry.object == objects::kDeviceType ||
        (entry.object.index == objects::kVendorId.index && entry.object != objects::kSerialNumber))
      set_default(entry, out);
    if (const auto base = predefined_base(entry, identity_->node); base && out.type == od::DataType::u32)
      out.default_value = od::NodeValue{od::Value(std::uint64_t{*base}), true};
    return out;
  }

  void set_default(const session::ScannedEntry& entry, od::Entry& out) {
    if (auto value = od::decode(out.type, entry.begin); value && entry.size == entry.begin.size())
      out.default_value = od::NodeValue{std::move(*value)};
  }

  /// Sub-index 0 of several counts them, unless it is filled at run time.
  void set_count(od::Object& object, std::span<const session::ScannedEntry> entries) {
    auto& first = object.entries.front();
    const bool is_stretched = sizes_unknown_ && entries.front().size == 4;
    if (first.address.sub != 0 || (entries.front().size != 1 && !is_stretched)) return;
    first.type = od::DataType::u8;
    if (first.name.starts_with("Sub-index")) first.name = "Highest sub-index supported";
    const bool counts = entries.front().begin.front() == object.entries.back().address.sub;
    if (counts && !od::writable(first.access) && object.index != objects::kErrorHistory.index)
      set_default(entries.front(), first);
    else
      first.default_value = {};
  }

  void describe(od::EdsFile& out) const {
    out.device.vendor_number = identity_->vendor_id.value_or(0);
    out.device.product_number = identity_->product_code.value_or(0);
    out.device.revision_number = identity_->revision.value_or(0);
    out.device.product_name = identity_->device_name;
  }

  const session::ScanState* state_;
  const session::Identity* identity_;
  const od::Dictionary* standard_;
  bool sizes_unknown_;
  std::set<ObjectAddress> mapped_;
};

}  // namespace

od::EdsFile learned_sheet(const session::ScanState& state, const session::Identity& identity,
                          const od::Dictionary* standard) {
  return SheetMaker(state, identity, standard).make();
}

}  // namespace servoctl::settings
