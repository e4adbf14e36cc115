#include "cli/terminal/begun_line.hpp"

#include <utility>

namespace servoctl::cli {
namespace {

bool is_quote(char c) { return c == '"' || c == '\''; }

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// Whether a backslash before `next` stands for it, and is not itself.
bool is_escape(char quote, char next, LineSyntax syntax) {
  const auto among = [next](std::string_view signs) { return signs.find(next) != std::string_view::npos; };
  if (quote == 0) return true;
  if (quote == '\'') return syntax == LineSyntax::fish && among("'\\");
  if (syntax == LineSyntax::servoctl) return true;
  return syntax == LineSyntax::fish ? among("\"$\\\n") : among("$`\"\\\n");
}

/// The others tell one word alone, which their shell took for none.
bool has_comments(LineSyntax syntax) { return syntax == LineSyntax::servoctl || syntax == LineSyntax::bash; }

}  // namespace

BegunLine begun_line(std::string_view line, std::string_view breaks, LineSyntax syntax) {
  BegunLine out;
  bool inside = false;
  std::size_t begin = 0;
  std::size_t kept_outside = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (out.quote == 0 && is_blank(c)) {
      if (inside) out.words.push_back(std::move(out.last));
      out.last.clear();
      inside = false;
      continue;
    }
    if (!inside && out.quote == 0 && c == '#' && has_comments(syntax)) {
      out.comment = true;
      break;
    }
    if (!inside) {
      begin = i;
      out.kept = 0;
    }
    inside = true;
    if (is_quote(c) && (out.quote == 0 || out.quote == c)) {
      // What was quoted in whole bash completes from its beginning.
      if (out.quote == 0) kept_outside = out.kept;
      out.kept = out.quote == 0 ? out.last.size() : kept_outside;
      out.quote = out.quote == 0 ? c : '\0';
    } else if (c == '\\' && i + 1 < line.size() && is_escape(out.quote, line[i + 1], syntax)) {
      out.last += line[++i];
    } else {
      out.last += c;
      // What bash takes for the beginning of a host or a variable belongs to the word behind it.
      const std::size_t own = c == '@' || c == '$' ? 1 : 0;
      if (out.quote == 0 && breaks.find(c) != std::string_view::npos) out.kept = out.last.size() - own;
    }
  }
  out.typed = inside ? line.size() - begin : 0;
  if (!inside) out.kept = 0;
  return out;
}

}  // namespace servoctl::cli
