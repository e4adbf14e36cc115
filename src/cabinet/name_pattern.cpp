#include "cabinet/name_pattern.hpp"

#include <cctype>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"

namespace servoctl::cabinet {

bool is_name(std::string_view name) {
  if (name.empty() || !is_utf8(name) || equals_nocase(name, "all")) return false;
  const auto first = static_cast<unsigned char>(name.front());
  if (first < 0x80 && std::isalpha(first) == 0) return false;
  for (std::string_view rest = name; !rest.empty();) {
    const auto c = decode_utf8(rest);
    if (!c.value || is_hidden_or_control(*c.value)) return false;
    const bool plain = *c.value >= 0x80 || std::isalnum(static_cast<int>(*c.value)) != 0;
    if (!plain && *c.value != '_' && *c.value != '-') return false;
    if (*c.value == 0x3000 || *c.value == 0xA0) return false;  // Spaces beyond ASCII.
    rest.remove_prefix(c.size);
  }
  return true;
}

Result<std::vector<std::string>> expand_name(const std::string& pattern) {
  const auto open = pattern.find('{');
  if (open == std::string::npos) return std::vector{pattern};
  const auto close = pattern.find('}', open);
  const auto inside = close == std::string::npos ? std::string() : pattern.substr(open + 1, close - open - 1);
  const auto ends = split(std::string_view(inside), '-');
  const auto refused = [&] {
    return fail(Errc::file,
                message("'{}': write a rising range in the braces, as feeder{{1-40}}", as_it_is(pattern)));
  };
  if (ends.size() != 2) return refused();
  const auto first = parse_digits(ends[0], 10);
  const auto last = parse_digits(ends[1], 10);
  if (!first || !last || *last < *first || *last - *first > 126) return refused();
  std::vector<std::string> out;
  for (auto i = *first; i <= *last; ++i)
    out.push_back(
        formatted("{}{:0{}}{}", pattern.substr(0, open), i, ends[0].size(), pattern.substr(close + 1)));
  return out;
}

}  // namespace servoctl::cabinet
