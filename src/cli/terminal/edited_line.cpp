#include "cli/terminal/edited_line.hpp"

#include <algorithm>
#include <utility>

#include "base/utf8.hpp"

namespace servoctl::cli {
namespace {

/// Letters of any script and digits; not what separates them on a command line.
bool is_of_word(const std::string& character) {
  const auto first = static_cast<unsigned char>(character.front());
  if (first >= 0x80) return true;
  return (first >= '0' && first <= '9') || (first >= 'A' && first <= 'Z') || (first >= 'a' && first <= 'z') ||
         first == '_';
}

}  // namespace

std::string EditedLine::joined(std::size_t from, std::size_t to) const {
  std::string out;
  for (auto i = from; i < to; ++i) out += characters_[i];
  return out;
}

void EditedLine::set(std::string_view text) {
  characters_.clear();
  cursor_ = 0;
  insert(text);
}

void EditedLine::insert(std::string_view text) {
  while (!text.empty()) {
    const auto point = decode_utf8(text);
    const auto bytes = text.substr(0, point.size);
    text.remove_prefix(point.size);
    if (bytes == "\t") {
      insert(" ");
      continue;
    }
    if (!point.value || is_hidden_or_control(*point.value)) continue;
    if (columns(*point.value) == 0) {
      if (cursor_ > 0) characters_[cursor_ - 1] += bytes;
      continue;
    }
    characters_.insert(characters_.begin() + static_cast<std::ptrdiff_t>(cursor_), std::string(bytes));
    ++cursor_;
  }
}

void EditedLine::replace_before(std::size_t bytes, std::string_view text) {
  while (bytes > 0 && cursor_ > 0) {
    bytes -= std::min(bytes, characters_[cursor_ - 1].size());
    erase_before();
  }
  insert(text);
}

void EditedLine::erase_before() {
  if (cursor_ == 0) return;
  --cursor_;
  erase_at();
}

void EditedLine::erase_at() {
  if (cursor_ < characters_.size())
    characters_.erase(characters_.begin() + static_cast<std::ptrdiff_t>(cursor_));
}

void EditedLine::left() {
  if (cursor_ > 0) --cursor_;
}

void EditedLine::right() {
  if (cursor_ < characters_.size()) ++cursor_;
}

void EditedLine::swap() {
  if (cursor_ == 0 || characters_.size() < 2) return;
  if (cursor_ == characters_.size()) --cursor_;
  std::swap(characters_[cursor_ - 1], characters_[cursor_]);
  ++cursor_;
}

void EditedLine::cut_word() {
  auto from = cursor_;
  while (from > 0 && characters_[from - 1] == " ") --from;
  while (from > 0 && characters_[from - 1] != " ") --from;
  cut(from, cursor_);
}

std::size_t EditedLine::word_start() const {
  auto at = cursor_;
  while (at > 0 && !is_of_word(characters_[at - 1])) --at;
  while (at > 0 && is_of_word(characters_[at - 1])) --at;
  return at;
}

std::size_t EditedLine::word_end() const {
  auto at = cursor_;
  while (at < characters_.size() && !is_of_word(characters_[at])) ++at;
  while (at < characters_.size() && is_of_word(characters_[at])) ++at;
  return at;
}

void EditedLine::cut(std::size_t from, std::size_t to) {
  if (from == to) return;
  cut_ = joined(from, to);
  characters_.erase(characters_.begin() + static_cast<std::ptrdiff_t>(from),
                    characters_.begin() + static_cast<std::ptrdiff_t>(to));
  cursor_ = from;
}

}  // namespace servoctl::cli
