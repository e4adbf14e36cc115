#include "cli/terminal/begun_line.hpp"

#include <utility>

namespace servoctl::cli {
namespace {

bool is_quote(char c) { return c == '"' || c == '\''; }

}  // namespace

BegunLine begun_line(std::string_view line, std::string_view breaks) {
  BegunLine out;
  bool inside = false;
  std::size_t begin = 0;
  std::size_t kept_outside = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (out.quote == 0 && (c == ' ' || c == '\t')) {
      if (inside) out.words.push_back(std::move(out.last));
      out.last.clear();
      inside = false;
      continue;
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
    } else if (c == '\\' && out.quote != '\'' && i + 1 < line.size()) {
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
