#include "drive/foreign_cells.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::drive {
namespace {

using Words = std::pair<std::string_view, std::string_view>;

constexpr auto kUnitWords = std::to_array<Words>({{"r/min", "rpm"},
                                                  {"rpm", "rpm"},
                                                  {"hz", "Hz"},
                                                  {"khz", "kHz"},
                                                  {"ms", "ms"},
                                                  {"v", "V"},
                                                  {"a", "A"},
                                                  {"℃", "°C"},
                                                  {"°", "deg"},
                                                  {"度", "deg"},
                                                  {"秒", "s"},
                                                  {"毫秒", "ms"}});

bool is_cell_digit(char c) { return c >= '0' && c <= '9'; }
bool is_hexadecimal_cell_digit(char c) {
  return is_cell_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}

std::size_t cell_number_length(std::string_view text) {
  std::size_t at = 0;
  if (at < text.size() && (text[at] == '-' || text[at] == '+')) ++at;
  const bool hex = text.substr(at).starts_with("0x") || text.substr(at).starts_with("0X");
  if (hex) at += 2;
  const auto from = at;
  while (at < text.size() &&
         (hex ? is_hexadecimal_cell_digit(text[at]) : is_cell_digit(text[at]) || text[at] == '.'))
    ++at;
  // "0..100" is a range, and no number with two points.
  while (at > from && text[at - 1] == '.') --at;
  const auto digits = text.substr(from, at - from);
  if (const auto twice = digits.find(".."); twice != std::string_view::npos) at = from + twice;
  return at > from ? at : 0;
}

/// Of `0.1` in `0.1 Hz`: digits, with a point between them at most.
std::size_t decimal_length(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size() && is_cell_digit(text[at])) ++at;
  if (at > 0 && at + 1 < text.size() && text[at] == '.' && is_cell_digit(text[at + 1]))
    for (++at; at < text.size() && is_cell_digit(text[at]);) ++at;
  return at;
}

/// What may follow the factor of a unit: no further calculation, no part of a number.
bool is_unit_word(std::string_view text) {
  if (text.empty()) return true;
  if (std::string_view("^/*,.-+=(").find(text.front()) != std::string_view::npos) return false;
  if (text.find("×") != std::string_view::npos || text.find("·") != std::string_view::npos) return false;
  if (text.find_first_of("*,=;") != std::string_view::npos) return false;
  // "ms/1000rpm", "rad/s2" and "m/s^2" are units; "Hz/10" is a calculation, "e3" an exponent.
  if (const auto per = text.find("/1000"); per != std::string_view::npos && per > 0) {
    const auto rest = text.substr(per + 5);
    if (!rest.empty() && std::isalpha(static_cast<unsigned char>(rest.front())) != 0)
      return is_unit_word(text.substr(0, per)) && is_unit_word(rest);
  }
  for (const std::string_view square : {"/s2", "/s^2"})
    if (text.ends_with(square)) text.remove_suffix(square.size());
  return std::none_of(text.begin(), text.end(), is_cell_digit) && text.find('^') == std::string_view::npos;
}

constexpr std::string_view kMonths[] = {"january",   "february", "march",    "april",
                                        "may",       "june",     "july",     "august",
                                        "september", "october",  "november", "december"};

bool is_month(std::string_view word) {
  constexpr std::size_t kShortest = 3;
  return word.size() >= kShortest && std::any_of(std::begin(kMonths), std::end(kMonths),
                                                 [&](auto month) { return month.starts_with(lower(word)); });
}

/// The words of `02. Jan 2026`; empty where they are joined by anything but blanks and `.-/`.
std::vector<std::string_view> date_words(std::string_view text) {
  std::vector<std::string_view> out;
  for (std::size_t at = 0; at < text.size();) {
    const auto end = std::min(text.find_first_of(" .-/", at), text.size());
    if (end > at) out.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

/// `2-Jan`, `02. Jan 2026`, `2026-01-02`, `1/2/2026`.
bool is_date(std::string_view text) {
  const auto words = date_words(text);
  const auto is_number = [](std::string_view word) { return parse_digits(word, 10).has_value(); };
  const auto months = std::count_if(words.begin(), words.end(), is_month);
  const auto numbers = std::count_if(words.begin(), words.end(), is_number);
  constexpr std::size_t kParts = 3;
  if (words.size() < 2 || words.size() > kParts || months + numbers != std::ssize(words)) return false;
  if (months > 0) return months == 1;
  constexpr std::size_t kYear = 4;
  return words.size() == kParts && (words.front().size() == kYear || words.back().size() == kYear);
}

/// `2.00E+05`, `2.00E-05`.
bool is_rounded_number(std::string_view text) {
  const auto exponent = text.find_first_of("eE");
  if (exponent == std::string_view::npos || !parse_real(text)) return false;
  return text.find('+') == exponent + 1 || text.substr(0, exponent).find('.') != std::string_view::npos;
}

}  // namespace

bool has_decimal_comma(std::string_view text) {
  for (std::size_t at = 1; at + 1 < text.size(); ++at)
    if (text[at] == ',' && is_cell_digit(text[at - 1]) && is_cell_digit(text[at + 1])) return true;
  return false;
}

bool is_changed_by_spreadsheet(std::string_view text) {
  if (is_date(text) || is_rounded_number(text)) return true;
  const auto month = text.find("月");
  return month != std::string_view::npos && text.ends_with("日") && is_cell_digit(text.front());
}

std::optional<std::pair<std::string, std::string>> family_unit(std::string_view text) {
  text = trim(text);
  for (const std::string_view word : {"1/min", "min-1", "min^-1", "min⁻¹", "U/min"})
    if (text == word) return std::pair(std::string(), std::string("rpm"));
  const auto length = decimal_length(text);
  const auto number = parse_real(text.substr(0, length));
  if (length > 0 && (!number || *number <= 0)) return std::nullopt;
  const auto scale = length > 0 ? std::string(text.substr(0, length)) : std::string();
  const auto rest = trim(text.substr(length));
  if (!is_unit_word(rest)) return std::nullopt;
  const auto folded = lower(rest);
  for (const auto& [word, unit] : kUnitWords)
    if (folded == word) return std::pair(scale, std::string(unit));
  return std::pair(scale, std::string(rest));
}

std::optional<std::pair<std::string, std::string>> family_range(std::string_view text) {
  text = trim(text);
  const bool bracket = text.size() > 2 && text.front() == '[' && text.back() == ']';
  if (bracket) text = trim(text.substr(1, text.size() - 2));
  if (constexpr std::string_view kBoth = "±"; text.starts_with(kBoth)) {
    const auto most = trim(text.substr(kBoth.size()));
    if (most.empty() || !is_cell_digit(most.front()) || cell_number_length(most) != most.size())
      return std::nullopt;
    return std::pair(formatted("-{}", most), std::string(most));
  }
  const auto first = cell_number_length(text);
  if (first == 0) return std::nullopt;
  auto rest = trim(text.substr(first));
  constexpr std::string_view kJoints[] = {"~", "～", "..", "…", "–", "—", "-", "to", "至", "到"};
  const auto joint = std::find_if(std::begin(kJoints), std::end(kJoints),
                                  [&](std::string_view one) { return rest.starts_with(one); });
  // "0,5" may be a number; in brackets it is none.
  if (joint != std::end(kJoints))
    rest.remove_prefix(joint->size());
  else if (bracket && rest.starts_with(','))
    rest.remove_prefix(1);
  else
    return std::nullopt;
  rest = trim(rest);
  if (cell_number_length(rest) != rest.size() || rest.empty()) return std::nullopt;
  return std::pair(std::string(text.substr(0, first)), std::string(rest));
}

namespace {

/// Lists of which every entry begins a line of the cell, or follows blanks: `0: off 1: on`.
std::string with_separators(std::string list) {
  for (std::size_t at = 1; at < list.size(); ++at) {
    const auto rest = std::string_view(list).substr(at);
    const auto length = list[at - 1] == ' ' && is_cell_digit(rest[0]) ? cell_number_length(rest) : 0;
    const auto after = trim(rest.substr(length));
    if (length > 0 && !after.empty() && (after[0] == '=' || after[0] == ':')) list[at - 1] = ';';
  }
  return list;
}

/// `A` and `0x1F`, which may be the number of a further entry; `dec` and `add` are words.
bool is_hexadecimal_word(std::string_view word) {
  constexpr std::size_t kDigits = 2;
  const bool prefix = word.starts_with("0x") || word.starts_with("0X");
  if (prefix) word.remove_prefix(2);
  return !word.empty() && (prefix || word.size() <= kDigits) &&
         std::all_of(word.begin(), word.end(), is_hexadecimal_cell_digit);
}

/// Whether a label may be more than one: `off1:on`, `on A:both`, `off /`.
bool is_doubtful_label(std::string_view label) {
  if (label.ends_with('/') || label.ends_with('|') || label.ends_with(',')) return true;
  for (std::size_t at = 1; at < label.size(); ++at) {
    if (label[at] != ':' && label[at] != '=') continue;
    const auto before = trim(label.substr(0, at));
    const auto blank = before.find_last_of(" ,/");
    const auto word = blank == std::string_view::npos ? before : before.substr(blank + 1);
    if (is_cell_digit(before.back()) || is_hexadecimal_word(word)) return true;
  }
  return false;
}

}  // namespace

std::optional<std::string> family_labels(std::string_view text) {
  std::string list(text);
  for (const auto& [from, to] : std::to_array<Words>({{"；", ";"}, {"：", ":"}, {"，", ";"}, {"、", ";"}}))
    for (auto at = list.find(from); at != std::string::npos; at = list.find(from))
      list.replace(at, from.size(), to);
  list = with_separators(std::move(list));
  const bool by_commas = list.find(';') == std::string::npos;
  std::string out;
  std::optional<double> before;
  for (const auto part : split(std::string_view(list), by_commas ? ',' : ';')) {
    const auto one = trim(part);
    if (one.empty()) continue;
    const auto length = cell_number_length(one);
    auto label = trim(one.substr(length));
    const bool joined = !label.empty() && (label[0] == '=' || label[0] == ':');
    if (length == 0 || !joined) return std::nullopt;
    label = trim(label.substr(1));
    while (label.ends_with(',')) label = trim(label.substr(0, label.size() - 1));
    const auto number = parse_real(one.substr(0, length));
    // "0:100" is no list, and numbers of one do not fall.
    if (cell_number_length(label) == label.size() || is_doubtful_label(label)) return std::nullopt;
    if (before && number && *number <= *before) return std::nullopt;
    before = number;
    append(out, formatted("{}={}", one.substr(0, length), label), ";");
  }
  return out;
}

ForeignObject family_object(std::string_view index, std::string_view sub) {
  std::string text(trim(index));
  // "2001-01h" is index and sub-index as well.
  std::replace(text.begin(), text.end(), '-', ':');
  sub = trim(sub);
  ForeignObject out;
  out.text = sub.empty() ? std::string(trim(index)) : formatted("{}:{}", index, sub);
  const bool index_alone = parse_object_address(text + ":0").has_value();
  if (!sub.empty() && !index_alone) return out;
  if (!sub.empty()) text += formatted(":{}", sub);
  out.has_sub = !sub.empty() || !index_alone;
  out.address = parse_object_address(text);
  if (!out.address) return out;
  if (const auto doubt = doubtful_sub(text)) out.doubtful = *doubt;
  out.text = formatted("0x{:04X}:{:02X}", out.address->index, out.address->sub);
  return out;
}

std::optional<std::string> family_code(std::string_view text, bool is_code) {
  text = trim(text);
  const bool prefix = text.starts_with("0x") || text.starts_with("0X");
  if (prefix) text.remove_prefix(2);
  constexpr std::size_t kDigits = 4;
  const bool suffix = !text.empty() && (text.back() == 'h' || text.back() == 'H');
  if (suffix) text.remove_suffix(1);
  if (!prefix && !suffix && !is_code) return std::nullopt;
  const bool fits = text.size() == kDigits || (prefix && text.size() < kDigits);
  const auto code = fits ? parse_digits(text, 16) : std::nullopt;
  return code ? std::optional(formatted("0x{:04X}", *code)) : std::nullopt;
}

}  // namespace servoctl::drive
