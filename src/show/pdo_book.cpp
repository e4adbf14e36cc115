#include "show/pdo_book.hpp"

#include <fmt/format.h>
#include <iterator>
#include <utility>

#include "base/number.hpp"
#include "canopen/cob_id.hpp"
#include "drive/standard_mode.hpp"
#include "drive/standard_objects.hpp"
#include "report/told.hpp"
#include "show/reading.hpp"
#include "show/records.hpp"
#include "show/value_words.hpp"

namespace servoctl::show {
namespace {

using report::Value;

/// PDOs of the pre-defined connection set (CiA 301, 7.3.5).
constexpr std::uint32_t kFirstPdoId = 0x181;
constexpr std::uint32_t kLastPdoId = 0x57F;

/// The bits of an entry as a number; at most 64.
std::uint64_t bits_at(ByteSpan data, std::size_t first, std::size_t count) {
  const auto from = data.subspan(std::min(first / 8, data.size()));
  const auto shift = first % 8;
  auto whole = load_le(from.first(std::min<std::size_t>(from.size(), 8))) >> shift;
  if (shift != 0 && from.size() > 8) whole |= std::uint64_t{from[8]} << (64 - shift);
  return count >= 64 ? whole : whole & ((std::uint64_t{1} << count) - 1);
}

od::DataType unsigned_type(std::size_t bytes) {
  return bytes == 1   ? od::DataType::u8
         : bytes == 2 ? od::DataType::u16
         : bytes <= 4 ? od::DataType::u32
                      : od::DataType::u64;
}

PdoField make_field(const drive::Profile* profile, bool chinese, std::uint8_t node, canopen::PdoEntry entry,
                    std::size_t first_bit) {
  PdoField out;
  out.entry = entry;
  out.first_bit = first_bit;
  out.target = drive::target_at(profile, entry.object);
  out.family = profile;
  const std::size_t bytes = (entry.bits + 7U) / 8U;
  out.meaning = drive::as_answered(drive::meaning(out.target, node), bytes);
  out.type = out.meaning.type_known && od::size_of(out.meaning.type) == bytes ? out.meaning.type
                                                                              : unsigned_type(bytes);
  out.name = chinese ? out.target.label_zh() : out.target.label();
  if (out.name.empty()) out.name = to_string(entry.object);
  report::JsonWriter head(out.head);
  head.member("index", entry.object.index);
  head.member("sub", entry.object.sub);
  head.text_or_null("name", out.target.label());
  return out;
}

/// The COB-ID of a PDO that was not told, as far as there is one; whether it is in use stays open.
std::uint32_t predefined_cob_id(const canopen::Pdo& pdo, std::uint8_t node) {
  constexpr std::uint16_t kPredefined = 4;
  if (pdo.number > kPredefined) return canopen::kPdoInvalid;
  const bool receive = pdo.direction == canopen::PdoDirection::receive;
  return canopen::kPdoInvalid | ((receive ? 0x100U : 0x080U) + 0x100U * pdo.number + node);
}

/// What the bits of the object mean; empty where they have no meaning of their own. Of the first axis
/// controlword and statusword are those of every drive.
std::string words_of_field(const PdoField& field, const od::Value& value, bool chinese, std::int8_t mode) {
  const auto* number = std::get_if<std::uint64_t>(&value);
  const auto& object = field.entry.object;
  const bool known =
      field.target.entry != nullptr || object == objects::kStatusword || object == objects::kControlword;
  if (number == nullptr || !known) return {};
  return value_words(object, *number, chinese, field.family, mode);
}

void write_value(const PdoField& field, const od::Value& value, std::int8_t mode, report::JsonWriter& json) {
  const auto& meaning = field.meaning;
  const auto raw = od_value(value);
  const bool as_sent = meaning.scale == 1 && meaning.encoding == od::Encoding::plain;
  const auto* label = drive::label_of(meaning, value);
  json.begin_record();
  json.written(field.head);
  json.member("value", as_sent ? raw : Value(drive::scaled(meaning, value)));
  json.member("raw", raw);
  json.text_or_null("unit", meaning.unit);
  json.text_or_null("label", label != nullptr ? label->label : words_of_field(field, value, false, mode));
  json.end_record();
}

bool fits_frame(const PdoView& view, ByteSpan data) {
  return view.assumed ? (view.pdo.bits() + 7) / 8 == data.size() : view.pdo.bits() <= data.size() * 8;
}

}  // namespace

od::Value PdoField::value(ByteSpan data) const {
  auto raw = bits_at(data, first_bit, entry.bits);
  if (od::is_signed(type) && entry.bits < 64 && (raw >> (entry.bits - 1U) & 1U) != 0)
    raw |= ~std::uint64_t{0} << entry.bits;
  if (od::is_signed(type)) return static_cast<std::int64_t>(raw);
  if (od::is_integer(type)) return raw;
  const auto decoded = od::decode(type, store_le(raw, (entry.bits + 7U) / 8U));
  return decoded ? *decoded : od::Value(raw);
}

std::int8_t PdoField::mode(ByteSpan data) const {
  constexpr std::size_t kModeBits = 8;
  return static_cast<std::int8_t>(bits_at(data, first_bit, std::min<std::size_t>(entry.bits, kModeBits)));
}

PdoView make_view(const drive::Profile* profile, bool chinese, std::uint8_t node, canopen::Pdo pdo) {
  PdoView out{node, std::move(pdo), {}, {}};
  out.profile = profile;
  out.name = canopen::name(out.pdo.direction, out.pdo.number);
  std::size_t at = 0;
  for (const auto& entry : out.pdo.entries) {
    if (!entry.is_gap() && entry.bits > 0 && entry.bits <= 64)
      out.fields.push_back(make_field(profile, chinese, node, entry, at));
    at += entry.bits;
  }
  return out;
}

void append_value(const PdoField& field, const od::Value& value, bool chinese, std::string& out,
                  std::int8_t mode) {
  const auto& meaning = field.meaning;
  const auto* number = std::get_if<std::uint64_t>(&value);
  if (const auto words = words_of_field(field, value, chinese, mode); !words.empty()) {
    const auto digits = drive::hex_digits(meaning, *number);
    fmt::format_to(std::back_inserter(out), "0x{:0{}X} ", *number, digits);
    out += words;
    return;
  }
  const bool plain = meaning.encoding == od::Encoding::plain;
  if (plain && meaning.scale != 1)
    out += plain_number(drive::scaled(meaning, value), 12);
  else if (plain && number != nullptr && !meaning.bits)
    out += fmt::format_int(*number).c_str();
  else if (const auto* whole = std::get_if<std::int64_t>(&value); plain && whole != nullptr)
    out += fmt::format_int(*whole).c_str();
  else
    out += drive::plain_text(meaning, value);
  if (!meaning.unit.empty()) (out += ' ') += meaning.unit;
  if (meaning.labels == nullptr || meaning.labels->empty()) return;
  if (const auto* label = drive::label_of(meaning, value))
    (out += ' ') += chinese && !label->label_zh.empty() ? label->label_zh : label->label;
}

bool shows_values(const PdoView& view, ByteSpan data) {
  return !view.fields.empty() && fits_frame(view, data);
}

std::int8_t mode_in(const PdoView& view, ByteSpan data) {
  for (const auto& field : view.fields) {
    if (field.entry.object != objects::kModeOfOperation && field.entry.object != objects::kModeDisplay)
      continue;
    const auto mode = field.mode(data);
    return view.profile == nullptr ? mode : drive::standard_mode(view.profile->rules.motion, mode);
  }
  return 0;
}

void append_values(const PdoView& view, ByteSpan data, bool chinese, std::string& out, std::int8_t mode) {
  if (!shows_values(view, data)) {
    const std::string_view why = view.fields.empty() ? "{} (mapping not known)"
                                 : view.assumed      ? "{} (not as long as its factory mapping)"
                                                     : "{} (shorter than its mapping)";
    out += report::told(chinese, why, to_hex(data));
    return;
  }
  if (const auto told = mode_in(view, data); told != 0) mode = told;
  bool first = true;
  for (const auto& field : view.fields) {
    if (!std::exchange(first, false)) out += chinese ? "，" : ", ";
    out += field.name;
    out += ' ';
    append_value(field, field.value(data), chinese, out, mode);
  }
}

void write_values(const PdoView& view, ByteSpan data, report::JsonWriter& json, std::int8_t mode) {
  if (const auto told = mode_in(view, data); told != 0) mode = told;
  json.begin_list();
  if (fits_frame(view, data))
    for (const auto& field : view.fields) write_value(field, field.value(data), mode, json);
  json.end_list();
}

PdoBook::Node& PdoBook::node(std::uint8_t id) {
  const auto known = nodes_.find(id);
  if (known != nodes_.end()) return known->second;
  auto& out = nodes_[id];
  if (const auto* family = family_of(id)) out.at_start = session::default_pdo_values(*family, id);
  out.now = out.at_start;
  rebuild(id);
  return out;
}

void PdoBook::set(std::uint8_t id, session::Values values) {
  auto& place = node(id);
  place.now = std::move(values);
  place.told.clear();
  for (const auto& value : place.now) place.told.insert(value.first);
  rebuild(id);
}

void PdoBook::learn(std::uint8_t id, ObjectAddress object, ByteSpan data) {
  if (!canopen::pdo_at(object.index)) return;
  auto& place = node(id);
  place.now[object] = Bytes(data.begin(), data.end());
  place.told.insert(object);
  rebuild(id);
}

void PdoBook::forget(std::uint8_t id) {
  const auto known = nodes_.find(id);
  if (known == nodes_.end()) return;
  known->second.told.clear();
  known->second.now = known->second.at_start;
  rebuild(id);
}

void PdoBook::rebuild(std::uint8_t id) {
  auto& place = nodes_[id];
  place.views.clear();
  for (auto& pdo : session::pdos_of(place.now)) {
    if (place.now.count({pdo.communication_index(), 1}) == 0) pdo.cob_id = predefined_cob_id(pdo, id);
    const bool assumed = place.told.count({pdo.mapping_index(), 0}) == 0;
    place.views.push_back(make_view(names_of(id), chinese_, id, std::move(pdo)));
    place.views.back().assumed = assumed;
  }
  index();
}

/// A producer goes before a consumer, one that is in use before one that is switched off.
void PdoBook::index() {
  by_id_.fill(nullptr);
  by_long_id_.clear();
  const auto rank = [](const PdoView& view) {
    return 2 * view.pdo.is_valid() + (view.pdo.direction == canopen::PdoDirection::transmit);
  };
  for (const auto& entry : nodes_)
    for (const auto& view : entry.second.views) {
      const auto can_id = view.can_id();
      const bool is_long = (can_id & canopen::kPdoExtended) != 0;
      if (!is_long && (can_id >= by_id_.size() || !canopen::service_of(can_id).empty())) continue;
      auto& place = is_long ? by_long_id_[can_id] : by_id_[can_id];
      if (place == nullptr || rank(view) > rank(*place)) place = &view;
    }
}

const PdoView* PdoBook::find(std::uint32_t can_id) {
  if (can_id >= by_id_.size()) {
    const auto found = by_long_id_.find(can_id);
    return found == by_long_id_.end() ? nullptr : found->second;
  }
  if (by_id_[can_id] != nullptr || can_id < kFirstPdoId || can_id > kLastPdoId) return by_id_[can_id];
  const auto id = static_cast<std::uint8_t>(can_id & canopen::kLastNode);
  if (id != 0) node(id);
  return by_id_[can_id];
}

}  // namespace servoctl::show
