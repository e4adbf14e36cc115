#include "cli/axis_word.hpp"

#include "base/format.hpp"

namespace servoctl::cli {
namespace {

Message axis_hint(const std::string& word, const Result<const cabinet::Cabinet*>& known) {
  if (!known)
    return message("'{}' may be an axis, but the cabinet file cannot be used: {}", as_it_is(word),
                   known.error().message);
  if (*known == nullptr) return "nodes are named by -n; there is no cabinet file here that names axes";
  const auto axes = (*known)->select(word);
  return axes ? Message() : message("{}; {}", axes.error().message, axes.error().hint);
}

}  // namespace

Error about_axis(Error error, const std::vector<std::string>& words, const CommandMatch& match,
                 const std::function<Result<const cabinet::Cabinet*>()>& cabinet) {
  const auto after = match.first + match.used;
  if (match.command == nullptr || !includes(match.command->needs, command::Needs::node) ||
      after >= words.size() || words[after].starts_with("-") || !error.message.says("unexpected argument"))
    return error;
  const auto more = axis_hint(words[after], cabinet());
  if (!more.empty()) error.hint = message("{}; {}", more, error.hint);
  return error;
}

}  // namespace servoctl::cli
