#include "show/reading.hpp"

#include <algorithm>
#include <map>
#include <span>

#include "base/format.hpp"
#include "base/number.hpp"
#include "canopen/node_id.hpp"
#include "drive/assumed_unit.hpp"
#include "drive/standard_objects.hpp"
#include "drive/word_bits.hpp"
#include "session/measure.hpp"
#include "show/records.hpp"
#include "show/value_words.hpp"

namespace servoctl::show {
namespace {

using report::List;
using report::Record;
using report::Show;
using report::Table;
using report::Value;

/// A long text ends where nobody reads on; JSON carries it whole.
std::string shortened(std::string text, std::size_t bytes) {
  constexpr std::size_t kMost = 200;
  if (text.size() <= kMost) return text;
  std::size_t end = kMost;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80) --end;
  return text.substr(0, end) + formatted("… ({} bytes; --to FILE keeps them)", bytes);
}

/// Asks the drives for the gear and ratings that the units of these readings need, each once.
void add_bridges(session::Session& session, const drive::Profile& profile, std::vector<Reading>& readings) {
  const auto question_of = [&](const Reading& reading) -> std::optional<session::MeasureQuestion> {
    const auto measure = drive::meaning(reading.target, reading.node).measure;
    if (!measure || !reading.bytes || profile.rules.units.count(*measure) == 0) return std::nullopt;
    if (drive::is_unit_assumed(reading.target)) return std::nullopt;
    return session::MeasureQuestion{reading.node, *measure};
  };
  std::vector<session::MeasureQuestion> questions;
  for (const auto& reading : readings)
    if (const auto question = question_of(reading))
      if (std::find(questions.begin(), questions.end(), *question) == questions.end())
        questions.push_back(*question);
  if (questions.empty()) return;
  const auto measures = session::read_measures(session, profile, questions);
  for (auto& reading : readings) {
    const auto question = question_of(reading);
    if (!question) continue;
    const auto place = std::find(questions.begin(), questions.end(), *question) - questions.begin();
    const auto& measure = measures[static_cast<std::size_t>(place)];
    const auto unit = drive::meaning(reading.target, reading.node).unit;
    if (measure) reading.bridge = drive::bridge(unit, reading.target.address, measure->value);
  }
}

bool is_refusal_of_one(const Reading& reading) {
  return reading.one_of_many && !reading.bytes && reading.bytes.error().code == Errc::sdo_abort;
}

/// In the place of the value.
Value missing_cell(const Desk& desk, const Reading& reading) {
  const auto code = reading.bytes.error().abort_code;
  if (!is_refusal_of_one(reading) || !code) return "-";
  return formatted("abort 0x{:08X} {}", *code, abort_words(desk, *code));
}

/// Of a consumer heartbeat time (CiA 301, 7.5.2.19): whose heartbeat, and how long without one.
std::string watched_text(ObjectAddress object, ByteSpan bytes) {
  constexpr std::size_t kBytes = 4;
  if (object.index != objects::kConsumerHeartbeatIndex || object.sub == 0 || bytes.size() != kBytes)
    return {};
  const auto word = load_le(bytes);
  const auto node = word >> 16U;
  if (node == 0 || node > canopen::kLastNode) return {};
  return formatted(" = node {}, {} ms", node, word & 0xFFFFU);
}

/// The units that drives name themselves, of those whose data only assume them.
std::map<std::uint8_t, session::DriveUnits> own_units(Desk& desk, std::span<const Reading> readings) {
  std::map<std::uint8_t, session::DriveUnits> out;
  const auto* profile = desk.profile != nullptr ? desk.profile : desk.standard;
  if (profile == nullptr || !drive::leaves_units_open(*profile) || desk.session == nullptr) return out;
  for (const auto& reading : readings)
    if (reading.bytes && drive::is_unit_assumed(reading.target) && out.count(reading.node) == 0)
      out.emplace(reading.node, session::DriveUnits(*desk.session, *profile, reading.node));
  return out;
}

/// That the drive has the object in another size than its data say.
void tell_size(Desk& desk, const Reading& reading) {
  const auto meaning = drive::meaning(reading.target, reading.node);
  if (!reading.bytes || reading.type || !meaning.type_known || !meaning.size_known) return;
  const auto fitted = drive::as_answered(meaning, reading.bytes->size());
  if (fitted.type == meaning.type) return;
  desk.notices.push_back(message("node {}, object {}: the drive answers {} bytes, not {}: taken as {}",
                                 node_name(reading.node), to_string(reading.target.address),
                                 reading.bytes->size(), od::size_of(meaning.type).value_or(0),
                                 od::name(fitted.type)));
}

List reading_row(const Desk& desk, const Reading& reading) {
  const bool chinese = desk.chinese;
  const auto& target = reading.target;
  const auto name = chinese ? target.label_zh() : target.label();
  List row{reading.node, to_string(target.address), target.address.index, target.address.sub,
           report::text_or_null(name)};
  if (target.parameter != nullptr)
    row.emplace_back(target.parameter->id);
  else
    row.emplace_back();
  if (!reading.bytes) {
    const auto type = reading.type              ? Value(od::name(*reading.type))
                      : target.entry != nullptr ? Value(od::name(target.entry->type))
                                                : Value();
    row.insert(row.end(), {missing_cell(desk, reading), type, Value(), Value(), Value(), Value(), Value(),
                           Value(), Value(), Value(), Value(),
                           error_record(reading.bytes.error(), abort_words(desk, reading.bytes.error()))});
    return row;
  }
  const auto& bytes = *reading.bytes;
  auto decoded = decode_value(reading, bytes);
  const bool number = std::holds_alternative<std::uint64_t>(decoded.raw.data()) ||
                      std::holds_alternative<std::int64_t>(decoded.raw.data());
  Value hex;
  // Where the value is hexadecimal already, once is enough.
  const bool told = drive::meaning(reading.target, reading.node).bits &&
                    std::holds_alternative<std::uint64_t>(decoded.raw.data());
  if (number && !told) hex = formatted("0x{:0{}X}", load_le(bytes), bytes.size() * 2);
  const auto label = label_text(decoded, chinese);
  row.insert(row.end(), {Value(decoded.text), Value(decoded.type), decoded.value, decoded.raw,
                         report::text_or_null(decoded.unit), decoded.encoding, decoded.familiar, Value(label),
                         decoded.label, hex.is_null() ? Value("") : hex, Value(to_hex(bytes)), Value()});
  return row;
}

}  // namespace

std::size_t size_of(const Reading& reading) {
  const auto meaning = drive::meaning(reading.target, reading.node);
  const auto type = reading.type         ? reading.type
                    : meaning.type_known ? std::optional(meaning.type)
                                         : std::nullopt;
  return type ? od::size_of(*type).value_or(0) : 0;
}

od::DataType type_of(const Reading& reading, ByteSpan bytes) {
  if (reading.type) return *reading.type;
  const auto meaning = drive::as_answered(drive::meaning(reading.target, reading.node), bytes.size());
  if (meaning.type_known) return meaning.type;
  const auto index = reading.target.address.index;
  if (index >= 0x1008 && index <= 0x100A)
    return od::DataType::string;  // CiA 301, 7.5.2: device name and versions.
  switch (bytes.size()) {
    case 1: return od::DataType::u8;
    case 2: return od::DataType::u16;
    case 4: return od::DataType::u32;
    case 8: return od::DataType::u64;
    default: break;
  }
  const bool printable = !bytes.empty() && std::all_of(bytes.begin(), bytes.end(),
                                                       [](std::uint8_t b) { return b == 0 || b >= 0x20; });
  return printable ? od::DataType::string : od::DataType::bytes;
}

namespace {

/// CiA 402 gives the objects of a further axis the meaning of those of the first, 800h lower, which the data
/// list; which input is which switch, they do not say of it.
bool is_of_further_axis(const Reading& reading) {
  const auto& object = reading.target.address;
  const auto first = drive::of_first_axis(object);
  return first != object && reading.family != nullptr && reading.family->dictionary.find(first) != nullptr;
}

}  // namespace

DecodedValue decode_value(const Reading& reading, ByteSpan bytes) {
  DecodedValue out;
  auto meaning = drive::as_answered(drive::meaning(reading.target, reading.node), bytes.size());
  if (reading.units != nullptr) reading.units->apply(reading.target, meaning);
  meaning.bridge = reading.bridge;
  const auto type = type_of(reading, bytes);
  if (!meaning.type_known) meaning.type = type;  // By its length: a COB-ID has eight digits.
  meaning.type_known = true;
  out.type = std::string(od::name(type));
  out.encoding = report::text_or_null(std::string(od::name(meaning.encoding)));
  const auto value = od::decode(type, bytes);
  if (!value) {
    out.value = to_hex(bytes);
    out.text = shortened(to_hex(bytes), bytes.size());
    return out;
  }
  const bool plain = meaning.encoding == od::Encoding::plain;
  out.raw = od_value(*value);
  out.value = meaning.scale == 1 && plain ? out.raw : Value(drive::scaled(meaning, *value));
  out.unit = std::string(meaning.unit);
  out.text = shortened(drive::plain_text(meaning, *value), bytes.size());
  if (meaning.scale != 1 && plain)
    out.text += formatted(" = {} {}", plain_number(drive::scaled(meaning, *value), 12), meaning.unit);
  else if (!meaning.unit.empty())
    out.text += " " + out.unit;
  auto familiar = familiar_value(meaning, *value);
  if (!familiar.text.empty()) out.text += " = " + familiar.text;
  out.text += watched_text(reading.target.address, bytes);
  out.familiar = std::move(familiar.record);
  if (const auto* label = drive::label_of(meaning, *value)) {
    out.label = label->label;
    out.label_zh = report::text_or_null(label->label_zh);
  } else if (const auto* word = std::get_if<std::uint64_t>(&*value);
             word != nullptr && (reading.target.entry != nullptr || is_of_further_axis(reading))) {
    const auto* family = reading.target.entry != nullptr ? reading.family : nullptr;
    out.label = report::text_or_null(value_words(reading.target.address, *word, false, family));
    if (!out.label.is_null()) out.word = WordOfObject{reading.target.address, *word, family};
  }
  return out;
}

void leave_units_open(Reading& reading) {
  static const session::DriveUnits kNone;
  reading.units = &kNone;
}

std::string label_text(const DecodedValue& value, bool chinese) {
  if (chinese && value.word)
    return value_words(value.word->object, value.word->value, true, value.word->family);
  const auto& label = chinese && !value.label_zh.is_null() ? value.label_zh : value.label;
  const auto* text = std::get_if<std::string>(&label.data());
  return text == nullptr ? std::string() : *text;
}

std::string brief_label(const DecodedValue& value, bool chinese) {
  if (!value.word) return label_text(value, chinese);
  return value_head(value.word->object, value.word->value, chinese, value.word->family);
}

FamiliarValue familiar_value(const drive::Meaning& meaning, const od::Value& value) {
  const auto familiar = drive::familiar(meaning, value);
  if (!familiar) return {};
  return {formatted("{} {}", plain_number(familiar->value, 7), familiar->unit),
          Record{{"value", familiar->value}, {"unit", familiar->unit}}};
}

Table reading_table(Desk& desk, std::vector<Reading> readings) {
  if (desk.profile != nullptr) add_bridges(*desk.session, *desk.profile, readings);
  const auto units = own_units(desk, readings);
  for (auto& reading : readings) reading.family = desk.profile != nullptr ? desk.profile : desk.standard;
  for (auto& reading : readings)
    if (const auto own = units.find(reading.node); own != units.end()) reading.units = &own->second;
  Table table;
  table.columns = {{"node"},
                   {"object", "", Show::text},
                   {"index", "", Show::json},
                   {"sub", "", Show::json},
                   {"name"},
                   {"id", "", Show::json},
                   {"text", "value", Show::text},
                   {"type", "", Show::json},
                   {"value", "", Show::json},
                   {"raw", "", Show::json},
                   {"unit", "", Show::json},
                   {"encoding", "", Show::json},
                   {"si", "", Show::json},
                   {"meaning", "label", Show::text},
                   {"label", "", Show::json},
                   {"hex", "", Show::text},
                   {"bytes", "", Show::json},
                   {"error", "", Show::json}};
  table.json_only =
      std::none_of(readings.begin(), readings.end(), [](const Reading& r) { return r.bytes.has_value(); });
  for (const auto& reading : readings) {
    tell_size(desk, reading);
    table.rows.push_back(reading_row(desk, reading));
    if (!reading.bytes && (table.json_only || !is_refusal_of_one(reading)))
      desk.errors.push_back(reading.bytes.error());
  }
  return table;
}

}  // namespace servoctl::show
