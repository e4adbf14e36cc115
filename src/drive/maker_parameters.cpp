#include "drive/maker_parameters.hpp"

#include <algorithm>
#include <map>

#include "base/text.hpp"
#include "drive/parameter_ids.hpp"

namespace servoctl::drive {
namespace {

constexpr std::uint16_t kFirstOfMaker = 0x2000;
constexpr std::uint16_t kLastOfMaker = 0x5FFF;
constexpr std::size_t kMostLetters = 4;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_decimal(char c) { return c >= '0' && c <= '9'; }
bool is_hexadecimal(char c) { return is_decimal(c) || (c >= 'A' && c <= 'F'); }
bool is_joint(char c) { return c == '.' || c == '-' || c == '_'; }

/// Whether a number may end before this character: what follows is the name.
bool ends_number(std::string_view rest) {
  return rest.empty() || !(is_letter(rest[0]) || is_decimal(rest[0]));
}

/// How many characters from `from` on are a group of digits; 0 for none.
std::size_t digits_at(std::string_view text, std::size_t from) {
  if (from >= text.size() || !is_decimal(text[from])) return 0;
  std::size_t end = from;
  while (end < text.size() && is_hexadecimal(text[end])) ++end;
  return ends_number(text.substr(end)) ? end - from : 0;
}

/// The length of the number at the beginning; 0 where there is none.
std::size_t number_length(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size() && is_letter(text[at])) ++at;
  if (at == 0 || at > kMostLetters) return 0;
  if (at < text.size() && (text[at] == '-' || text[at] == '_') && digits_at(text, at + 1) > 0) ++at;
  const auto first = digits_at(text, at);
  if (first == 0) return 0;
  const auto digits = text.substr(at, first);
  const bool is_long = first > 2 || (first == 2 && std::all_of(digits.begin(), digits.end(), is_decimal));
  at += first;
  std::size_t groups = 1;
  while (at < text.size() && is_joint(text[at])) {
    const auto next = digits_at(text, at + 1);
    if (next == 0) break;
    at += 1 + next;
    ++groups;
  }
  // "DI1 function" is the name of an input and "I2C" of a bus, not a number.
  return groups > 1 || is_long ? at : 0;
}

/// `Pr1` of `Pr1.01`; a number of one part tells no group.
std::string group_of(std::string_view id) {
  const auto joint = id.find_last_of(".-_");
  const auto group = id.substr(0, joint == std::string_view::npos ? 0 : joint);
  return !group.empty() && is_decimal(group.back()) ? std::string(group) : std::string();
}

constexpr std::string_view kBrackets[] = {"[", "]", "(", ")", "【", "】", "（", "）", "「", "」"};
constexpr std::string_view kSeparators[] = {" ", "\t", ":",  "：", "-", "–",  "—",
                                            "_", ",",  "，", "、", ".", "。", "　"};

/// Takes one of them off the beginning.
bool take(std::string_view& text, std::string_view sign) {
  if (!text.starts_with(sign)) return false;
  text.remove_prefix(sign.size());
  return true;
}

void skip_separators(std::string_view& text) {
  while (std::any_of(std::begin(kSeparators), std::end(kSeparators),
                     [&](std::string_view sign) { return take(text, sign); }))
    continue;
}

od::Parameter parameter_of(const od::Object& object, const od::Entry& entry) {
  od::Parameter out;
  out.id = to_string(entry.address);
  out.placed = true;
  out.object = entry.address;
  out.type = entry.type;
  out.access = entry.access;
  out.unit = entry.unit;
  out.scale = entry.scale;
  out.encoding = entry.encoding;
  const auto plain = [](const std::optional<od::NodeValue>& value) {
    return value && !value->plus_node_id ? std::optional(value->value) : std::nullopt;
  };
  out.default_value = plain(entry.default_value);
  out.min = plain(entry.low);
  out.max = plain(entry.high);
  out.effect = entry.effect;
  out.labels = entry.labels;
  out.name = object.entries.size() == 1 ? entry.name : object.name + ": " + entry.name;
  out.name_zh = entry.name_zh;
  out.command = entry.command;
  out.is_volatile = entry.is_volatile;
  out.doubts = entry.doubts;
  out.note = entry.note;
  out.note_zh = entry.note_zh;
  out.line = entry.line;
  return out;
}

}  // namespace

bool looks_like_number(std::string_view word) {
  const auto letters = std::find_if_not(word.begin(), word.end(), is_letter) - word.begin();
  const auto rest = word.substr(static_cast<std::size_t>(letters));
  return letters > 0 && letters <= static_cast<std::ptrdiff_t>(kMostLetters) &&
         std::any_of(rest.begin(), rest.end(), is_decimal) &&
         std::all_of(rest.begin(), rest.end(), [](char c) { return is_hexadecimal(c) || is_joint(c); });
}

std::optional<NumberedName> split_number(std::string_view name) {
  auto rest = trim(name);
  std::string_view closing;
  for (std::size_t i = 0; i < std::size(kBrackets) && closing.empty(); i += 2)
    if (take(rest, kBrackets[i])) closing = kBrackets[i + 1];
  const auto length = number_length(rest);
  if (length == 0) return std::nullopt;
  NumberedName out{std::string(rest.substr(0, length)), {}};
  rest.remove_prefix(length);
  if (!closing.empty() && !take(rest, closing)) return std::nullopt;
  skip_separators(rest);
  if (rest.empty()) return std::nullopt;
  out.name = rest;
  return out;
}

std::vector<od::Parameter> maker_parameters(const od::Dictionary& dictionary) {
  std::vector<od::Parameter> out;
  std::vector<std::optional<NumberedName>> numbered;
  std::map<std::string, int> uses;
  for (const auto& object : dictionary.objects()) {
    if (object.index < kFirstOfMaker || object.index > kLastOfMaker) continue;
    for (const auto& entry : object.entries) {
      // The count of a record or array is no setting.
      if (entry.address.sub == 0 && (object.entries.size() > 1 || object.code != od::ObjectCode::var))
        continue;
      if (entry.type == od::DataType::domain) continue;
      out.push_back(parameter_of(object, entry));
      numbered.push_back(split_number(entry.name));
      // A name that is a number and nothing else is one as well.
      const auto name = trim(entry.name);
      if (numbered.back() || looks_like_number(name))
        ++uses[canonical_id(numbered.back() ? numbered.back()->id : std::string(name))];
    }
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!numbered[i] || uses[canonical_id(numbered[i]->id)] > 1) continue;
    out[i].id = numbered[i]->id;
    out[i].group = group_of(numbered[i]->id);
    out[i].name = numbered[i]->name;
    out[i].placed = false;
  }
  return out;
}

}  // namespace servoctl::drive
