#include "base/folded.hpp"

#include <algorithm>

#include "base/text.hpp"
#include "base/utf8.hpp"

namespace servoctl {
namespace {

constexpr char32_t kFullWidthFirst = 0xFF01;
constexpr char32_t kFullWidthLast = 0xFF5E;
constexpr char32_t kIdeographicSpace = 0x3000;

/// Wide signs that stand at the end of what is before them, or at the beginning of what follows.
constexpr std::u32string_view kCloses = U"，。、；：？！）】」』》〉”’％";
constexpr std::u32string_view kOpens = U"（【「『《〈“‘";

bool is_one_of(char32_t c, std::u32string_view signs) { return signs.find(c) != std::u32string_view::npos; }

/// Whether a line may end between these two characters, neither of which is a blank.
bool may_break(char32_t before, char32_t after) {
  const bool wide = columns(before) == 2 || columns(after) == 2;
  return wide && !is_one_of(after, kCloses) && !is_one_of(before, kOpens) &&
         !(after < 0x80 &&
           std::string_view(",.;:!?)]%").find(static_cast<char>(after)) != std::string_view::npos);
}

/// What no line may end in.
struct Piece {
  std::string text;
  bool after_blank = false;
};

std::vector<Piece> pieces_of(std::string_view text) {
  std::vector<Piece> out;
  char32_t before = ' ';
  while (!text.empty()) {
    const auto c = decode_utf8(text);
    const auto value = c.value.value_or(U'?');
    const bool blank = value == ' ' || value == '\n' || value == '\t';
    if (!blank) {
      if (before == ' ' || may_break(before, value)) out.push_back({{}, before == ' '});
      out.back().text += text.substr(0, c.size);
    }
    before = blank ? U' ' : value;
    text.remove_prefix(c.size);
  }
  return out;
}

}  // namespace

std::string folded(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto c = decode_utf8(text);
    const auto value = c.value.value_or(0);
    if (value == kIdeographicSpace || value == ' ' || (value >= '\t' && value <= '\r')) {
      if (!out.empty() && out.back() != ' ') out += ' ';
    } else if (value >= kFullWidthFirst && value <= kFullWidthLast) {
      out += static_cast<char>(value - kFullWidthFirst + '!');
    } else {
      out += text.substr(0, c.size);
    }
    text.remove_prefix(c.size);
  }
  return lower(trim(out));
}

std::vector<std::string> broken_lines(std::string_view text, std::size_t width) {
  std::vector<std::string> out(1);
  std::size_t used = 0;
  for (const auto& piece : pieces_of(text)) {
    const auto size = display_width(piece.text);
    const std::size_t gap = used > 0 && piece.after_blank ? 1 : 0;
    if (used > 0 && used + gap + size > width) {
      out.emplace_back();
      used = 0;
    } else if (gap > 0) {
      out.back() += ' ';
      ++used;
    }
    out.back() += piece.text;
    used += size;
  }
  return out;
}

}  // namespace servoctl
