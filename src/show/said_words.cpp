#include "show/said_words.hpp"

#include <algorithm>
#include <optional>

#include "base/folded.hpp"
#include "base/text.hpp"
#include "show/words_in_text.hpp"

namespace servoctl::show {
namespace {

bool is_chinese_byte(char c) { return static_cast<unsigned char>(c) >= 0x80; }

/// With a blank between Chinese and the digits behind it.
std::string with_numbers_apart(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (is_decimal_digit(c) && !out.empty() && is_chinese_byte(out.back())) out += ' ';
    out += c == '=' ? ' ' : c;
  }
  return out;
}

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> out;
  for (const auto word : split(text, ' '))
    if (!word.empty()) out.emplace_back(word);
  return out;
}

/// The text without this word; empty where it is not in it. Of a word in ASCII its beginning is enough.
std::optional<std::string> without_word(std::string text, std::string_view word) {
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const bool chinese = is_chinese_byte(word.front());
    if (!chinese && at > 0 && text[at - 1] != ' ' && !is_chinese_byte(text[at - 1])) continue;
    auto end = at + word.size();
    if (!is_chinese_byte(word.back()))
      while (end < text.size() && text[end] != ' ' && !is_chinese_byte(text[end])) ++end;
    return text.replace(at, end - at, " ");
  }
  return std::nullopt;
}

/// The same of all words of a name, in any order.
std::optional<std::string> without_name(std::string text, std::string_view name) {
  std::optional<std::string> out = std::move(text);
  for (const auto& word : words_of(name))
    if (out) out = without_word(std::move(*out), word);
  return out;
}

}  // namespace

SaidWords::SaidWords(std::string_view typed, std::span<const drive::EverydayWords> everyday)
    : all_(words_of(with_numbers_apart(folded(typed)))) {
  rest_ = {searchable(typed)};
  if (!everyday.empty()) find_things(everyday);
}

void SaidWords::find_things(std::span<const drive::EverydayWords> everyday) {
  auto rest = rest_.front();
  for (std::size_t found = things_.size();; found = things_.size()) {
    std::size_t longest = 0;
    std::string left;
    for (const auto& thing : everyday)
      for (const auto& word : thing.words) {
        const auto name = searchable(word);
        auto without = name.size() > longest ? without_name(rest, name) : std::nullopt;
        if (!without) continue;
        things_.resize(found);
        things_.push_back(&thing);
        longest = name.size();
        left = std::move(*without);
      }
    if (longest == 0) break;
    rest = std::move(left);
  }
  rest_ = words_of(with_numbers_apart(rest));
  if (things_.size() == 1 && rest_.empty()) thing_ = things_.front();
}

bool SaidWords::are_in(std::string_view text) const {
  const auto has = [&](const std::string& word) { return has_word(text, word); };
  const auto names = [&](const drive::EverydayWords* thing) {
    return std::any_of(thing->words.begin(), thing->words.end(),
                       [&](const std::string& word) { return has_word(text, searchable(word)); });
  };
  if (!all_.empty() && std::all_of(all_.begin(), all_.end(), has)) return true;
  return !things_.empty() && std::all_of(things_.begin(), things_.end(), names) &&
         std::all_of(rest_.begin(), rest_.end(), has);
}

}  // namespace servoctl::show
