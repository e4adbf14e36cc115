#include "cli/hint_place.hpp"

#include <fmt/format.h>
#include <vector>

#include "cli/words.hpp"

namespace servoctl::cli {
namespace {

using command::Needs;

struct Place {
  std::string_view option;
  std::string_view short_name;
};
constexpr Place kBus{"--bus", "-b"};
constexpr Place kNode{"--node", "-n"};
constexpr Place kDrive{"--drive", "-d"};
constexpr Place kCabinet{"--cabinet", "--cabinet"};

/// Whether all of the command's words are there: one that is only named has no place.
bool is_whole(const Result<ParsedLine>& named) { return named && named->command != nullptr; }

/// As a shell takes it for one word; the prompt and batch files do too.
std::string quoted(const std::string& word) {
  auto out = join_words(std::vector<std::string>{word});
  const bool special = word.find_first_of("&?*$;|<>()[]{}!#~") != std::string::npos;
  return out == word && special ? "'" + word + "'" : out;
}

void add(const Place& place, const ParsedLine& line, const ParsedLine& named,
         std::vector<std::string>& words) {
  if (!line.arguments.has(place.option) || named.arguments.has(place.option)) return;
  words.emplace_back(place.short_name);
  words.push_back(quoted(std::string(line.arguments.text(place.option))));
}

std::string placed(std::string_view command, const ParsedLine& line) {
  const auto words = split_words(command);
  if (!words || words->empty() || command.find("…") != std::string_view::npos) return std::string(command);
  const auto named = parse_line(*words);
  if (!is_whole(named)) return std::string(command);
  const auto needs = named->command->needs;
  std::vector<std::string> more;
  if (includes(needs, Needs::node)) add(kNode, line, *named, more);
  if (includes(needs, Needs::dictionary)) add(kDrive, line, *named, more);
  if (includes(needs, Needs::bus)) add(kBus, line, *named, more);
  if (includes(needs, Needs::bus) || named->command->path.starts_with("cabinet"))
    add(kCabinet, line, *named, more);
  return more.empty() ? std::string(command)
                      : std::string(command) + " " + fmt::to_string(fmt::join(more, " "));
}

}  // namespace

std::string with_place(std::string_view text, const ParsedLine& line) {
  std::string out;
  for (;;) {
    const auto begin = text.find('`');
    const auto end = begin == std::string_view::npos ? begin : text.find('`', begin + 1);
    if (end == std::string_view::npos) return out + std::string(text);
    out += text.substr(0, begin + 1);
    out += placed(text.substr(begin + 1, end - begin - 1), line) + "`";
    text.remove_prefix(end + 1);
  }
}

Outcome with_place(Outcome outcome, const ParsedLine& line) {
  for (auto& error : outcome.errors) error.hint = with_place(error.hint, line);
  for (auto& notice : outcome.notices) notice = with_place(notice, line);
  return outcome;
}

}  // namespace servoctl::cli
