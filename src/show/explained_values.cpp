// What a value of an object means, and what a bare number may be.
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "base/bytes.hpp"
#include "base/folded.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/standard_objects.hpp"
#include "report/catalogue.hpp"
#include "show/explanation_parts.hpp"
#include "show/printed_number.hpp"
#include "show/reading.hpp"
#include "show/value_words.hpp"

namespace servoctl::show {
namespace {

/// What somebody typed: `6041h=0x0637`, `statusword 0x1288`.
struct ValueQuestion {
  std::string subject;
  std::int64_t value = 0;
};

std::optional<ValueQuestion> value_question(const TopicQuery& query) {
  const auto text = folded(query.whole());
  const auto end = text.find_last_of(query.has_value() ? "=" : " ");
  if (end == std::string::npos) return std::nullopt;
  const auto digits = trim(std::string_view(text).substr(end + 1));
  auto value = parse_signed(digits);
  if (const auto code = code_in(digits, 16); !value && is_marked_hex(digits) && code)
    value = static_cast<std::int64_t>(*code);
  if (!value) return std::nullopt;
  return ValueQuestion{std::string(trim(std::string_view(text).substr(0, end))), *value};
}

/// The bytes that carry the value; empty where the type has no fixed size or they do not hold it.
Bytes bytes_of(std::int64_t value, std::size_t size) {
  if (size == 0 || size > 8) return {};
  const auto bits = size * 8;
  if (bits < 64 && (value >> bits) != 0 && (value >> (bits - 1)) != -1) return {};
  Bytes out;
  for (std::size_t i = 0; i < size; ++i)
    out.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (i * 8)));
  return out;
}

/// A text in both languages.
struct Both {
  std::string english;
  std::string chinese;
};

Both words_in_both(ObjectAddress object, std::uint64_t value, const drive::Profile& family) {
  return {value_words(object, value, false, &family), value_words(object, value, true, &family)};
}

/// The class of an error code that no list has: 7580h is of 7500h (CiA 402-1, error codes).
const drive::Fault* class_of_code(const drive::Profile& profile, std::uint16_t code) {
  for (const unsigned mask : {0xFFF0U, 0xFF00U, 0xF000U}) {
    const auto of_class = static_cast<std::uint16_t>(code & mask);
    if (of_class == 0) return nullptr;
    const auto& own = profile.faults;
    const auto* known = profile.parent_fault(of_class);
    if (known != nullptr) return known;
    const auto listed = std::find_if(own.begin(), own.end(), [&](const drive::Fault& fault) {
      return profile.is_generic() && fault.code == of_class;
    });
    if (listed != own.end()) return &*listed;
  }
  return nullptr;
}

/// A code of 603Fh that the family lists, or its class.
Both words_of_code(const drive::Profile& profile, std::uint16_t code) {
  for (const auto& fault : profile.faults)
    if (fault.code == code) return {fault.name, fault.name_zh.empty() ? fault.name : fault.name_zh};
  const auto* fault = class_of_code(profile, code);
  if (fault == nullptr) return {};
  constexpr std::string_view kClass = "not in the list of {}; of the class 0x{:04X}: {}";
  return {
      formatted(kClass, profile.family, *fault->code, fault->name),
      formatted(fmt::runtime(report::chinese_word(kClass)), profile.family, *fault->code, fault->name_zh)};
}

/// What the bytes mean: the state of a statusword, a label, a number in its unit.
Both meaning_of(const drive::Profile& profile, const drive::Target& target, const Bytes& bytes) {
  if (target.address == objects::kErrorCode)
    return words_of_code(profile, static_cast<std::uint16_t>(load_le(bytes)));
  if (auto words = words_in_both(target.address, load_le(bytes), profile); !words.english.empty())
    return words;
  const auto decoded = decode_value(Reading{1, target, std::nullopt, bytes}, bytes);
  const auto* label = std::get_if<std::string>(&decoded.label.data());
  const auto* label_zh = std::get_if<std::string>(&decoded.label_zh.data());
  if (label == nullptr || label->empty()) return {decoded.text, decoded.text};
  return {*label, label_zh != nullptr && !label_zh->empty() ? *label_zh : *label};
}

/// Whether one of the bits that a cell names (`4`, `12-13`) is set.
bool has_set_bit(std::string_view cell, std::uint64_t value) {
  const auto dash = cell.find('-');
  const auto first = parse_digits(cell.substr(0, dash), 10);
  const auto last = dash == std::string_view::npos ? first : parse_digits(cell.substr(dash + 1), 10);
  if (!first || !last) return false;
  for (auto bit = std::min(*first, *last); bit <= std::max(*first, *last) && bit < 64; ++bit)
    if ((value >> bit & 1U) != 0) return true;
  return false;
}

/// The family's words for the bits of an object, of those that are set.
void add_set_bits(const Library& library, const drive::Target& target, std::uint64_t value,
                  drive::Topic& out) {
  if (target.entry == nullptr) return;
  const TopicQuery object(target.entry->name);
  const auto bits =
      std::find_if(library.topics.begin(), library.topics.end(), [&](const drive::Topic& topic) {
        return topic.kind == "bits" && !topic.value && !topic.columns.empty() &&
               folded(topic.columns[0]) == "bit" && object.names(topic.name);
      });
  if (bits == library.topics.end()) return;
  for (const auto& row : bits->rows)
    if (has_set_bit(row.cells.front(), value)) out.rows.push_back(row);
  if (out.rows.empty()) return;
  out.columns = bits->columns;
  out.columns_zh = bits->columns_zh;
  out.words_zh = bits->words_zh;
  out.line = bits->line;
}

/// Whether the words are the name or address of the target itself, not a part of its name.
bool is_named(const drive::Target& target, const drive::Profile& profile, const TopicQuery& subject) {
  if (const auto address = parse_object_address(subject.whole())) return *address == target.address;
  if (target.parameter != nullptr)
    return subject.names(target.parameter->id) || subject.names(target.parameter->name) ||
           subject.names(target.parameter->name_zh);
  const auto* object = profile.dictionary.object(target.address.index);
  return object != nullptr && target.entry != nullptr &&
         (subject.names(target.entry->name) || subject.names(target.entry->name_zh) ||
          subject.names(object->name) || subject.names(drive::entry_name(*object, *target.entry)));
}

void add_row(drive::Topic& topic, std::string_view head, Both text) {
  topic.rows.push_back({{std::string(head)}, std::move(text.english), std::move(text.chinese), topic.line});
}

}  // namespace

void add_value(const TopicQuery& query, const Library& library, std::vector<Explanation>& out) {
  const auto& profile = *library.profile;
  const auto asked = value_question(query);
  if (!asked || asked->subject.empty()) return;
  const auto target = drive::resolve(&profile, asked->subject);
  if (!target || !is_named(*target, profile, TopicQuery(asked->subject))) return;
  const bool told = std::any_of(out.begin(), out.end(), [&](const Explanation& each) {
    return each.topic.value == asked->value && each.topic.object == target->address;
  });
  if (told) return;
  const auto bytes = bytes_of(asked->value, size_of(Reading{1, *target, std::nullopt, Bytes{}}));
  if (bytes.empty()) return;
  const auto number = formatted("0x{:0{}X}", load_le(bytes), bytes.size() * 2);
  const auto meaning = meaning_of(profile, *target, bytes);
  const auto label = target->label();
  const auto label_zh = target->label_zh();
  const auto name = to_string(target->address);
  auto topic = topic_heading(
      profile.family, "value", formatted("{} = {}", name, number),
      formatted("{} {} = {}: {}", name, label, number, meaning.english),
      formatted("{} {} = {}：{}", name, label_zh.empty() ? label : label_zh, number, meaning.chinese));
  if (meaning.english.empty()) topic.title.resize(topic.title.size() - 2);
  topic.object = target->address;
  topic.value = asked->value;
  add_set_bits(library, *target, load_le(bytes), topic);
  out.push_back({std::move(topic), Found::value});
  if (target->address != objects::kErrorCode) return;
  std::vector<Explanation> faults;
  add_faults(TopicQuery(number), profile, false, false, faults);
  for (auto& fault : faults)
    if (fault.found == Found::fault) out.push_back(std::move(fault));
}

void add_number(const TopicQuery& query, const drive::Profile& profile, std::vector<Explanation>& out) {
  constexpr std::int64_t kLeast = 0x20;  // Below, a number alone says nothing.
  const auto text = folded(query.whole());
  const auto hex = is_marked_hex(text) ? code_in(text, 4) : std::nullopt;
  const auto value = hex ? static_cast<std::int64_t>(*hex) : parse_signed(text).value_or(-1);
  if (value < kLeast || value > 0xFFFF) return;
  const auto word = static_cast<std::uint16_t>(value);
  constexpr std::string_view kTitle = "{} = 0x{:04X}: what it means as a value of 16 bits";
  auto topic =
      topic_heading(profile.family, "value", formatted("0x{:04X}", word), formatted(kTitle, word, word),
                    formatted(fmt::runtime(report::chinese_word(kTitle)), word, word));
  topic.columns = {"object"};
  topic.columns_zh = {std::string(report::chinese_word("object"))};
  topic.line = "CiA 402-2, 8.4";
  if (auto code = words_of_code(profile, word); !code.english.empty())
    add_row(topic, "0x603F", std::move(code));
  add_row(topic, "0x6041", words_in_both(objects::kStatusword, word, profile));
  add_row(topic, "0x6040", words_in_both(objects::kControlword, word, profile));
  if (!hex) std::rotate(topic.rows.begin(), topic.rows.end() - 2, topic.rows.end());
  out.push_back({std::move(topic), Found::value});
}

}  // namespace servoctl::show
