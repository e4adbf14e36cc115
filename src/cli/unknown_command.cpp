#include "cli/unknown_command.hpp"

#include <fmt/format.h>
#include <span>
#include <string_view>

#include "base/text.hpp"
#include "cli/batch/batch.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"

namespace servoctl::cli {
namespace {

/// Paths, and the first words of those that have two.
std::vector<std::string> known_commands() {
  std::vector<std::string> out;
  for (const auto* command : command::registry()) {
    out.emplace_back(command->path);
    if (const auto parts = split(command->path, ' '); parts.size() > 1) out.emplace_back(parts.front());
  }
  return out;
}

/// Words of other tools for what every `lss` command does by itself (CiA 305: switch state).
bool switches_by_itself(std::string_view said) {
  constexpr std::string_view kGroup = "lss ";
  if (!said.starts_with(kGroup)) return false;
  for (const std::string_view word : {"switch", "mode", "config"})
    if (said.substr(kGroup.size()).starts_with(word)) return true;
  return false;
}

/// Of a group that is there, a second word that is not.
Error unknown_in_group(const std::string& said, std::span<const std::string> paths) {
  auto hint = split(said, ' ').size() > 1 ? did_you_mean(said, paths) : std::string();
  std::vector<std::string> quoted;
  for (const auto& path : paths) quoted.push_back(fmt::format("`{}`", path));
  if (hint.empty() || switches_by_itself(said)) hint = fmt::format("use {}", one_of(quoted));
  if (switches_by_itself(said))
    hint = "each LSS command selects its slave by itself, and lets it go in the end; " + hint;
  return make_error(Errc::usage, fmt::format("'{}' is not a command", said), std::move(hint));
}

}  // namespace

Error unknown_command(const std::vector<std::string>& words, std::size_t first) {
  const auto& word = words[first];
  const bool goes_on = first + 1 < words.size() && !words[first + 1].starts_with('-');
  const auto said = goes_on ? word + " " + words[first + 1] : word;
  std::vector<std::string> in_group;
  for (const auto* command : command::registry())
    if (const auto parts = split(command->path, ' '); parts.size() > 1 && parts.front() == word)
      in_group.emplace_back(command->path);
  if (!in_group.empty()) return unknown_in_group(said, in_group);
  if (goes_on && (word == "exit" || word == "quit"))
    return make_error(Errc::usage, fmt::format("'{}' stands alone", word), {});
  if (const auto* of_prompt = command::find_prompt_word(word); of_prompt != nullptr)
    return make_error(
        Errc::usage, fmt::format("'{}' is a word of the prompt, and no command", of_prompt->name),
        fmt::format("`servoctl` alone opens the prompt; `help {}` says what it does", of_prompt->name));
  if (is_batch_word(word))
    return make_error(Errc::usage, fmt::format("'{}' is a word of batch files, and no command", word),
                      "`run FILE` runs one; `help run` tells its words");
  const auto known = known_commands();
  auto hint = goes_on ? did_you_mean(said, known) : std::string();
  if (hint.empty()) hint = did_you_mean(word, known);
  if (hint.empty()) hint = "`help` lists the commands";
  return make_error(Errc::usage, fmt::format("'{}' is not a command", word), std::move(hint));
}

}  // namespace servoctl::cli
