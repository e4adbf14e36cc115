#include "command/roff.hpp"

#include <algorithm>
#include <cstdint>

#include "base/format.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"

namespace servoctl::command {
namespace {

constexpr std::size_t kLineLength = 78;
constexpr std::string_view kBreak = "\\:";  ///< A place where a line may be broken, without a hyphen.

std::string escaped(char32_t c, bool literal) {
  switch (c) {
    case U'\\': return "\\e";
    case U'\'': return "\\(aq";
    case U'"': return "\\(dq";
    case U'`': return "\\(ga";
    case U'^': return "\\(ha";
    case U'~': return "\\(ti";
    case U'-': return literal ? "\\-" : "-";
    case U'…': return "...";
    default: break;
  }
  return c < 0x80 ? std::string(1, static_cast<char>(c))
                  : formatted("\\[u{:04X}]", static_cast<std::uint32_t>(c));
}

/// A word of prose, `node-ID`, has hyphens; an option, a path or a number has minus signs.
bool is_prose(std::string_view word) {
  const auto letter = [&](std::size_t at) {
    return at < word.size() && ((word[at] | 0x20) >= 'a' && (word[at] | 0x20) <= 'z');
  };
  for (std::size_t at = 0; at < word.size(); ++at)
    if (word[at] == '-' && (at == 0 || !letter(at - 1) || !letter(at + 1))) return false;
  return word.find_first_of("/_=$:@*0123456789<>{}") == std::string_view::npos &&
         word.find('.') >= word.size() - 1;
}

std::string escaped(std::string_view text, bool literal) {
  std::string out;
  while (!text.empty()) {
    const auto next = decode_utf8(text);
    out += escaped(next.value.value_or(U'\uFFFD'), literal);
    text.remove_prefix(next.size);
  }
  return out;
}

/// With places between its wide characters at which groff may break the line: it takes Chinese for one word.
std::string breakable(std::string_view word) {
  std::string out;
  for (const auto piece : unbroken_pieces(word)) {
    if (piece.data() != word.data()) out += kBreak;
    out += escaped(piece, !is_prose(piece));
  }
  return out;
}

/// The words with spaces and line breaks between them as they were.
std::string escaped_prose(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto end = std::min(text.find_first_of(" \n"), text.size());
    out += breakable(text.substr(0, end));
    if (end < text.size()) out += text[end];
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::string with_bold_code(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto begin = text.find('`');
    const auto end = begin == std::string_view::npos ? begin : text.find('`', begin + 1);
    if (end == std::string_view::npos) return out + escaped_prose(text);
    out += escaped_prose(text.substr(0, begin)) + "\\fB" +
           escaped(text.substr(begin + 1, end - begin - 1), true) + "\\fR";
    text.remove_prefix(end + 1);
  }
  return out;
}

/// groff puts more space behind a sentence that ends a line than behind one that does not.
bool ends_sentence(std::string_view word) {
  return word.ends_with('.') && !word.ends_with("..") && word.size() > 2;
}

}  // namespace

std::string roff_literal(std::string_view text) {
  const bool request = text.starts_with('.') || text.starts_with("…");
  return (request ? "\\&" : "") + escaped(text, true);
}

std::string roff_text(std::string_view text) {
  std::string out;
  std::string line;
  const auto flush = [&] {
    if (line.empty()) return;
    out += (line.front() == '.' ? "\\&" : "") + line + "\n";
    line.clear();
  };
  // A long word of many characters goes on in the next line of the source: `\` joins the two.
  const auto add = [&](std::string_view word) {
    while (!word.empty()) {
      const auto at = word.find(kBreak);
      const auto piece = at == std::string_view::npos ? word : word.substr(0, at + kBreak.size());
      if (line.ends_with(kBreak) && line.size() + piece.size() > kLineLength) {
        line += '\\';
        flush();
      }
      line += piece;
      word.remove_prefix(piece.size());
    }
  };
  const auto prose = with_bold_code(text);
  for (const auto paragraph : split(prose, '\n')) {
    for (const auto word : split(paragraph, ' ')) {
      if (word.empty()) continue;
      const auto first = std::min(word.find(kBreak), word.size());
      if (!line.empty() && line.size() + 1 + first > kLineLength) flush();
      if (!line.empty()) line += ' ';
      add(word);
      if (ends_sentence(word)) flush();
    }
    flush();
  }
  return out;
}

}  // namespace servoctl::command
