#include "show/words_in_text.hpp"

#include <algorithm>
#include <cstddef>

#include "base/folded.hpp"

namespace servoctl::show {
namespace {

constexpr char kApart = '\x1f';  ///< Stands in no text.

/// Of a word in ASCII.
bool is_word_sign(char c) { return (c >= 'a' && c <= 'z') || is_decimal_digit(c); }

bool is_digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), is_decimal_digit);
}

/// Whether digits between these places are all of a number: not the end of `0.15`, `-15` or the name `P3-15`,
/// nor the beginning of `15.5`. The number of a name without others (`Er.15`) and both ends of a range
/// (`8-15`) are.
bool is_whole_number(std::string_view text, std::size_t at, std::size_t end) {
  if (end + 1 < text.size() && (text[end] == '.' || text[end] == ',') && is_decimal_digit(text[end + 1]))
    return false;
  if (at == 0) return true;
  const auto mark = text[at - 1];
  if (std::string_view(".,-_").find(mark) == std::string_view::npos) return true;
  auto begin = at - 1;
  while (begin > 0 && is_word_sign(text[begin - 1])) --begin;
  const auto before = text.substr(begin, at - 1 - begin);
  if (before.empty()) return mark != '-';
  return std::none_of(before.begin(), before.end(), is_decimal_digit) || (mark == '-' && is_digits(before));
}

}  // namespace

bool is_decimal_digit(char c) { return c >= '0' && c <= '9'; }

std::string searchable(std::string_view text) {
  const auto is_chinese = [](char c) { return static_cast<unsigned char>(c) >= 0x80; };
  auto out = folded(text);
  std::size_t size = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const bool beside = out[i] == ' ' && (is_chinese(out[i - 1]) || is_chinese(out[i + 1]));
    if (!beside) out[size++] = out[i];
  }
  out.resize(size);
  return out;
}

std::string searchable(std::initializer_list<std::string_view> texts) {
  std::string out;
  for (const auto text : texts) (out += searchable(text)) += kApart;
  return out;
}

bool has_word(std::string_view text, std::string_view word) {
  if (word.empty()) return false;
  const bool bounded = is_word_sign(word.front());
  const bool number = is_digits(word);
  for (auto at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const auto end = at + word.size();
    const bool begins = at == 0 || !is_word_sign(text[at - 1]);
    const bool ends = end == text.size() || !is_word_sign(text[end]);
    const bool fits = number ? ends && is_whole_number(text, at, end) : ends || word.size() > 2;
    if (!bounded || (begins && fits)) return true;
  }
  return false;
}

}  // namespace servoctl::show
