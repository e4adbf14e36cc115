#include "drive/name_key.hpp"

#include <algorithm>

#include "base/folded.hpp"
#include "base/text.hpp"
#include "od/dictionary.hpp"

namespace servoctl::drive {
namespace {

bool is_of_other_script(char c) { return static_cast<unsigned char>(c) >= 0x80; }
bool is_word(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || is_of_other_script(c); }

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// `50` is no part of `150`, and `增益1` none of `增益10`.
bool cuts_number(std::string_view key, std::size_t at, std::size_t size) {
  const auto end = at + size;
  return (at > 0 && is_digit(key[at - 1]) && is_digit(key[at])) ||
         (end < key.size() && is_digit(key[end - 1]) && is_digit(key[end]));
}

}  // namespace

std::string name_key(std::string_view name) {
  if (std::none_of(name.begin(), name.end(), is_of_other_script)) return od::identifier(name);
  std::string out;
  bool gap = false;
  for (const char c : folded(name)) {
    if (!is_word(c)) {
      gap = !out.empty();
      continue;
    }
    if (gap && !is_of_other_script(c) && !is_of_other_script(out.back())) out += '_';
    gap = false;
    out += c;
  }
  return out;
}

std::vector<std::string> key_words(std::string_view text) {
  std::vector<std::string> out;
  const auto key = name_key(text);
  for (const auto word : split(key, '_'))
    if (!word.empty()) out.emplace_back(word);
  return out;
}

bool has_words(std::string_view key, const std::vector<std::string>& words) {
  return !words.empty() && std::all_of(words.begin(), words.end(), [key](const std::string& word) {
    auto at = key.find(word);
    while (at != std::string_view::npos && cuts_number(key, at, word.size())) at = key.find(word, at + 1);
    return at != std::string_view::npos;
  });
}

}  // namespace servoctl::drive
