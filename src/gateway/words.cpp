#include "gateway/words.hpp"

namespace servoctl::gateway {
namespace {

bool is_blank(char byte) { return byte == ' ' || byte == '\t' || byte == '\r' || byte == '\n'; }

/// Takes a word in quotes off the beginning of `rest`; false when it does not end as it should.
bool take_quoted(std::string_view& rest, std::string& word) {
  std::size_t at = 1;
  for (; at < rest.size(); ++at) {
    if (rest[at] != '"') {
      word += rest[at];
      continue;
    }
    if (at + 1 == rest.size() || rest[at + 1] != '"') break;
    word += rest[at++];
  }
  if (at >= rest.size()) return false;
  rest.remove_prefix(at + 1);
  return rest.empty() || is_blank(rest.front());
}

}  // namespace

std::optional<std::vector<std::string>> split_words(std::string_view line) {
  std::vector<std::string> out;
  for (;;) {
    while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    if (line.empty() || line.front() == '#') return out;
    auto& word = out.emplace_back();
    if (line.front() == '"') {
      if (!take_quoted(line, word)) return std::nullopt;
      continue;
    }
    while (!line.empty() && !is_blank(line.front()) && line.front() != '#') {
      if (line.front() == '"') return std::nullopt;
      word += line.front();
      line.remove_prefix(1);
    }
  }
}

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char byte : text) {
    if (byte == '\0' || byte == '\r' || byte == '\n') continue;  // The line would end there.
    out += byte;
    if (byte == '"') out += byte;
  }
  return out + '"';
}

}  // namespace servoctl::gateway
