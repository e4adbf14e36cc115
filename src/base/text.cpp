#include "base/text.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/format.hpp"
#include "base/utf8.hpp"

namespace servoctl {
namespace {

char lower_char(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// A byte that is no UTF-8 is shown as one character.
std::size_t columns_of(const CodePoint& c) { return c.value ? columns(*c.value) : 1; }

/// What does not begin a line, and what does not end one (JIS X 4051, GB/T 15834): marks that belong to the
/// character beside them.
constexpr std::u32string_view kNotFirst = U"，。；：！？、）】》」』〉”’…·％～,.;:!?)]}%";
constexpr std::u32string_view kNotLast = U"（【《「『〈“‘([{";

bool has(std::u32string_view marks, const CodePoint& c) {
  return c.value && marks.find(*c.value) != std::u32string_view::npos;
}

/// The line in words. What stands in backticks is typed as it is read: it is one, where there is room for it.
std::vector<std::string_view> words_of(std::string_view line, std::size_t room) {
  std::vector<std::string_view> out;
  std::size_t begin = 0;
  for (std::size_t at = 0; at < line.size(); ++at) {
    if (line[at] == '`') {
      const auto close = line.find('`', at + 1);
      if (close != std::string_view::npos && close - at < room) at = close;
    } else if (line[at] == ' ') {
      out.push_back(line.substr(begin, at - begin));
      begin = at + 1;
    }
  }
  out.push_back(line.substr(begin));
  return out;
}

std::string wrapped_line(std::string_view line, std::size_t indent, std::size_t width) {
  std::string out;
  std::size_t used = 0;
  for (const auto word : words_of(line, width > indent ? width - indent : 0)) {
    std::size_t blank = 1;
    for (const auto piece : unbroken_pieces(word)) {
      const auto size = display_width(piece);
      if (used > 0 && width > 0 && indent + used + blank + size > width) {
        out += '\n' + std::string(indent, ' ');
        used = 0;
      }
      if (used > 0) {
        out.append(blank, ' ');
        used += blank;
      }
      out += piece;
      used += size;
      blank = 0;
    }
  }
  return out;
}

}  // namespace

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), lower_char);
  return out;
}

std::string upper(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return out;
}

bool equals_nocase(std::string_view a, std::string_view b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(),
                                            [](char x, char y) { return lower_char(x) == lower_char(y); });
}

bool starts_with_nocase(std::string_view text, std::string_view prefix) {
  return text.size() >= prefix.size() && equals_nocase(text.substr(0, prefix.size()), prefix);
}

std::string_view trim(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const auto first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const auto at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
    if (text.empty()) parts.emplace_back();
  }
  return parts;
}

void append(std::string& list, std::string_view part, std::string_view separator) {
  if (!list.empty()) list += separator;
  list += part;
}

std::size_t display_width(std::string_view text) {
  std::size_t width = 0;
  while (!text.empty()) {
    const auto c = decode_utf8(text);
    width += columns_of(c);
    text.remove_prefix(c.size);
  }
  return width;
}

std::string pad_right(std::string_view text, std::size_t width) {
  const auto used = display_width(text);
  return std::string(text) + std::string(width > used ? width - used : 0, ' ');
}

std::string pad_left(std::string_view text, std::size_t width) {
  const auto used = display_width(text);
  return std::string(width > used ? width - used : 0, ' ') + std::string(text);
}

std::string clip(std::string_view text, std::size_t width) {
  if (display_width(text) <= width) return std::string(text);
  if (width == 0) return {};
  std::size_t used = 0;
  std::size_t at = 0;
  while (at < text.size()) {
    const auto c = decode_utf8(text.substr(at));
    if (used + columns_of(c) > width - 1) break;
    used += columns_of(c);
    at += c.size;
  }
  return std::string(text.substr(0, at)) + "…";
}

std::vector<std::string_view> unbroken_pieces(std::string_view word) {
  std::vector<std::string_view> out;
  std::size_t begin = 0;
  std::size_t at = 0;
  CodePoint last{};
  bool code = false;
  while (at < word.size()) {
    const auto c = decode_utf8(word.substr(at));
    const bool wide = columns_of(c) == 2 || columns_of(last) == 2;
    if (at > begin && wide && !code && !has(kNotFirst, c) && !has(kNotLast, last)) {
      out.push_back(word.substr(begin, at - begin));
      begin = at;
    }
    if (word[at] == '`') code = !code;
    last = c;
    at += c.size;
  }
  out.push_back(word.substr(begin));
  return out;
}

std::string wrapped(std::string_view text, std::size_t indent, std::size_t width) {
  std::string out;
  for (const auto line : split(text, '\n')) {
    if (line.data() != text.data()) out += '\n';
    out += wrapped_line(line, indent, width);
  }
  return out;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> above(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(above.begin(), above.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower_char(a[i - 1]) == lower_char(b[j - 1]);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (same ? 0U : 1U)});
      const bool swapped = i > 1 && j > 1 && lower_char(a[i - 1]) == lower_char(b[j - 2]) &&
                           lower_char(a[i - 2]) == lower_char(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, above);
    std::swap(above, row);
  }
  return above[b.size()];
}

std::vector<std::string> nearest(std::string_view text, std::span<const std::string> candidates,
                                 std::size_t most) {
  std::vector<std::pair<std::size_t, const std::string*>> ranked;
  const std::size_t limit = std::max<std::size_t>(1, (text.size() + 2) / 3);
  for (const auto& candidate : candidates) {
    const std::size_t difference =
        candidate.size() > text.size() ? candidate.size() - text.size() : text.size() - candidate.size();
    const bool prefix = text.size() >= 3 && starts_with_nocase(candidate, text);
    if (difference > limit && !prefix) continue;
    const std::size_t distance = prefix ? 1 : edit_distance(text, candidate);
    if (distance <= limit) ranked.emplace_back(distance, &candidate);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& x, const auto& y) { return x.first < y.first; });
  std::vector<std::string> out;
  for (const auto& entry : ranked) {
    if (out.size() == most) break;
    if (std::find(out.begin(), out.end(), *entry.second) == out.end()) out.push_back(*entry.second);
  }
  return out;
}

}  // namespace servoctl
