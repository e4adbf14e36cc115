#include "report/phrase.hpp"

#include <algorithm>

#include "base/number.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"

namespace servoctl::report {
namespace {

/// So many places are tried for the pieces of one text; what needs more is left alone.
constexpr std::size_t kMostSteps = 200;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_figure(char c) { return c >= '0' && c <= '9'; }

/// Between Chinese and Chinese there is no blank, which stands beside a number or a name alone.
void append_beside(std::string_view text, std::string& out) {
  if (out.ends_with(' ') && begins_in_chinese(text) &&
      ends_in_chinese(std::string_view(out).substr(0, out.size() - 1)))
    out.pop_back();
  if (text.starts_with(' ') && ends_in_chinese(out) && begins_in_chinese(text.substr(1)))
    text.remove_prefix(1);
  out += text;
}

/// Where the placeholder that begins here ends, behind its brace; 0 where none begins.
std::size_t place_end(std::string_view text) {
  std::size_t at = 1;
  while (at < text.size() && is_figure(text[at])) ++at;
  if (at < text.size() && text[at] == '}') return at + 1;
  if (at == text.size() || text[at] != ':') return 0;
  // A width or precision may be a placeholder too: `{:{}}`.
  std::size_t depth = 1;
  for (++at; at < text.size() && text[at] != '\n'; ++at) {
    if (text[at] == '{') ++depth;
    if (text[at] == '}' && --depth == 0) return at + 1;
  }
  return 0;
}

/// `04X`, `.1f`, `+`: but not `>8` of a text.
bool is_number_format(std::string_view format) {
  if (format.empty()) return false;
  if (std::string_view("dxXbBofFgGeEaA").find(format.back()) != std::string_view::npos) return true;
  return format.find_first_of("+.#") != std::string_view::npos || format.front() == '0';
}

/// As fmt writes them, with blanks before it where it is padded.
bool begins_like_number(std::string_view text) {
  text = trim(text);
  if (text == "inf" || text == "nan" || text == "-inf") return true;
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  return !text.empty() && std::string_view("0123456789ABCDEF").find(text.front()) != std::string_view::npos;
}

}  // namespace

Phrase::Phrase(std::string_view format) {
  for (std::size_t i = 0; i < format.size(); ++i) {
    const auto begin = i;
    while (i < format.size() && format[i] != '{' && format[i] != '}') ++i;
    pieces_.back() += format.substr(begin, i - begin);
    if (i == format.size()) break;
    const char c = format[i];
    const bool doubled = (c == '{' || c == '}') && i + 1 < format.size() && format[i + 1] == c;
    const auto size = c == '{' && !doubled ? place_end(format.substr(i)) : 0;
    if (size > 0) {
      add_place(format.substr(i + 1, size - 2));
      i += size - 1;
      continue;
    }
    if (doubled) ++i;
    pieces_.back() += c;
  }
  for (const auto& piece : pieces_) size_ += piece.size();
  for (const auto& piece : pieces_)
    letters_ += static_cast<std::size_t>(std::count_if(piece.begin(), piece.end(), is_letter));
  bool code = false;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const auto& before = pieces_[i];
    const char last = before.empty() ? ' ' : before.back();
    code = code != (std::count(before.begin(), before.end(), '`') % 2 == 1);
    places_[i].quoted = code || (last == '\'' && pieces_[i + 1].starts_with('\''));
    places_[i].suffix = is_letter(last);
  }
}

void Phrase::keep(std::size_t argument) {
  for (auto& place : places_)
    if (place.argument == argument) place.quoted = true;
}

void Phrase::add_place(std::string_view inside) {
  const auto colon = inside.find(':');
  const auto written = parse_digits(inside.substr(0, colon), 10);
  places_.push_back(
      {.argument = written ? static_cast<std::size_t>(*written) : places_.size(),
       .number = colon != std::string_view::npos && is_number_format(inside.substr(colon + 1))});
  pieces_.emplace_back();
}

std::vector<std::string_view> Phrase::words() const {
  std::vector<std::string_view> out;
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    const std::string_view piece = pieces_[p];
    for (std::size_t begin = 0; begin < piece.size();) {
      std::size_t end = begin;
      while (end < piece.size() && (is_letter(piece[end]) || is_figure(piece[end]))) ++end;
      const bool whole_left = begin > 0 || p == 0;
      const bool whole_right = end < piece.size() || p + 1 == pieces_.size();
      if (end > begin && whole_left && whole_right) out.push_back(piece.substr(begin, end - begin));
      begin = std::max(end, begin + 1);
    }
  }
  return out;
}

bool Phrase::fits(std::size_t place, std::string_view value) const {
  const auto& p = places_[place];
  return p.number ? begins_like_number(value) : !value.empty() || p.suffix || p.quoted;
}

bool Phrase::match_from(std::size_t piece, std::string_view rest, std::vector<std::string_view>& out,
                        std::size_t& steps) const {
  // `rest` begins at the place before the piece. Of places without a text between them the first takes all
  // that is there: those behind it are often empty.
  const auto place = piece - 1;
  while (piece + 1 < pieces_.size() && pieces_[piece].empty()) ++piece;
  const auto empty = piece - 1 - place;
  const std::string_view wanted = pieces_[piece];
  const bool last = piece + 1 == pieces_.size();
  const auto first = last ? (rest.ends_with(wanted) ? rest.size() - wanted.size() : std::string_view::npos)
                          : rest.find(wanted);
  for (auto at = first; at != std::string_view::npos && steps < kMostSteps; at = rest.find(wanted, at + 1)) {
    ++steps;
    const auto value = rest.substr(0, at);
    if (fits(place, value)) {
      out.push_back(value);
      out.insert(out.end(), empty, std::string_view());
      if (last || match_from(piece + 1, rest.substr(at + wanted.size()), out, steps)) return true;
      out.resize(place);
    }
    if (last) return false;
  }
  return false;
}

std::optional<std::vector<std::string_view>> Phrase::match(std::string_view text) const {
  if (places_.empty())
    return text == pieces_.front() ? std::optional(std::vector<std::string_view>()) : std::nullopt;
  if (!text.starts_with(pieces_.front()) || !text.ends_with(pieces_.back())) return std::nullopt;
  std::vector<std::string_view> out;
  std::size_t steps = 0;
  if (!match_from(1, text.substr(pieces_.front().size()), out, steps)) return std::nullopt;
  return out;
}

std::string Phrase::with(const std::vector<std::string>& arguments) const {
  auto out = pieces_.front();
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (places_[i].argument < arguments.size()) append_beside(arguments[places_[i].argument], out);
    append_beside(pieces_[i + 1], out);
  }
  return out;
}

}  // namespace servoctl::report
