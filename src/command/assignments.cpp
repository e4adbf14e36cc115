#include "command/assignments.hpp"

#include "base/format.hpp"

namespace servoctl::command {

Result<std::vector<Assignment>> parse_assignments(std::span<const std::string> words) {
  std::vector<Assignment> out;
  if (words.size() == 2 && words[0].find('=') == std::string::npos) {
    out.push_back({words[0], words[1]});
    return out;
  }
  if (words.size() == 1 && words[0].find('=') == std::string::npos)
    return fail(Errc::usage, message("no value is given for '{}'", as_it_is(words[0])),
                message("`param set {0} VALUE` sets it; `param explain {0}` shows its range, `param get {0}` "
                        "reads it",
                        as_it_is(words[0].find(' ') == std::string::npos ? words[0] : "'" + words[0] + "'")));
  for (const auto& word : words) {
    const auto equals = word.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == word.size())
      return fail(
          Errc::usage, message("'{}' is not an assignment", as_it_is(word)),
          "write `param set ID VALUE` or `param set ID=VALUE ID=VALUE`; a unit stands behind its number "
          "without a blank: 45Hz");
    out.push_back({std::string_view(word).substr(0, equals), std::string_view(word).substr(equals + 1)});
  }
  return out;
}

}  // namespace servoctl::command
