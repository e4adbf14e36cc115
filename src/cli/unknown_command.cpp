#include "cli/unknown_command.hpp"

#include <span>
#include <string_view>

#include "base/format.hpp"
#include "base/offer.hpp"
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

/// What people type who know the word from other tools or from what they want, and what does it here. By
/// meaning: the nearest spelling may be a command that does something else.
struct Meaning {
  std::string_view said;
  std::string_view hint;
};
constexpr Meaning kMeanings[] = {
    {"abort", "`stop` stops and de-energises every drive"},
    {"alarm", "`fault show` shows the faults of a drive, `fault list` all that its family can have"},
    {"alarms", "`fault show` shows the faults of a drive, `fault list` all that its family can have"},
    {"candump", "`monitor` shows the frames of the bus"},
    {"clear", "`fault reset` resets a fault, `fault clear-history` clears the history"},
    {"connect", "there is no connection to make: name the bus with -b, such as -b can0, then `scan`"},
    {"devices", "`scan` finds the drives of a bus"},
    {"download", "`write` writes one object (SDO download), `restore` a whole backup"},
    {"dump", "`backup` saves all values of a drive, `objects` lists them, `monitor` shows frames"},
    {"errors", "`fault show` shows the faults of a drive, `fault list` all that its family can have"},
    {"get", "`read` reads an object, `param get` a panel parameter"},
    {"go",
     "`jog` turns a motor, `move` goes to a position, `enable` energises a drive and leaves it enabled"},
    {"halt", "`stop` stops and de-energises every drive"},
    {"load", "`restore` writes a backup to a drive"},
    {"nodes", "`scan` finds the drives of a bus"},
    {"off", "`disable` de-energises a drive, `stop` stops and de-energises every drive"},
    {"on", "`enable` energises a drive and leaves it enabled"},
    {"list", "`scan` lists the drives of a bus, `param list` the parameters of one, `objects` its objects"},
    {"params", "`param list` lists the parameters of a drive"},
    {"reboot", "`nmt reset` restarts a node"},
    {"reset",
     "`fault reset` resets a fault, `nmt reset` restarts a node, `defaults` restores factory values"},
    {"restart", "`nmt reset` restarts a node"},
    {"save", "`store` keeps the values over power-off, `backup` saves them in a file"},
    {"sdo", "`read` and `write` are SDO upload and download"},
    {"sdo download", "`write` writes one object (SDO download)"},
    {"sdo read", "`read` reads an object (SDO upload)"},
    {"sdo upload", "`read` reads an object (SDO upload)"},
    {"sdo write", "`write` writes one object (SDO download)"},
    {"set", "`write` writes an object, `param set` a panel parameter"},
    {"slaves", "`scan` finds the drives of a bus"},
    {"start", "`nmt start` makes a node operational, `enable` energises a drive, `jog` turns a motor"},
    {"upload", "`read` reads one object (SDO upload), `backup` all values of a drive"},
};

/// Empty where the words mean nothing more than they spell.
std::string hint_by_meaning(std::string_view word, std::string_view said) {
  for (const auto text : {said, word})
    for (const auto& meaning : kMeanings)
      if (equals_nocase(meaning.said, text)) return std::string(meaning.hint);
  return {};
}

/// Of a group that is there, a second word that is not.
Error unknown_in_group(const std::string& said, std::span<const std::string> paths) {
  Message hint = split(said, ' ').size() > 1 ? did_you_mean(said, paths) : std::string();
  std::vector<std::string> quoted;
  for (const auto& path : paths) quoted.push_back(formatted("`{}`", path));
  if (hint.empty() || switches_by_itself(said)) hint = message("use {}", one_of(quoted));
  if (switches_by_itself(said))
    hint = "each LSS command selects its slave by itself, and lets it go in the end; " + hint;
  return make_error(Errc::usage, message("'{}' is not a command", as_it_is(said)), std::move(hint));
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
    return make_error(Errc::usage, message("'{}' stands alone", as_it_is(word)), {});
  if (const auto* of_prompt = command::find_prompt_word(word); of_prompt != nullptr)
    return make_error(
        Errc::usage, message("'{}' is a word of the prompt, and no command", as_it_is(of_prompt->name)),
        message("`servoctl` alone opens the prompt; `help {}` says what it does", as_it_is(of_prompt->name)));
  if (auto meaning = hint_by_meaning(word, said); !meaning.empty())
    return make_error(Errc::usage, message("'{}' is not a command", as_it_is(word)), std::move(meaning));
  if (is_batch_word(word))
    return make_error(Errc::usage, message("'{}' is a word of batch files, and no command", as_it_is(word)),
                      "`run FILE` runs one; `help run` tells its words");
  const auto known = known_commands();
  auto hint = goes_on ? did_you_mean(said, known) : std::string();
  if (hint.empty()) hint = did_you_mean(word, known);
  if (hint.empty()) hint = "`help` lists the commands";
  return make_error(Errc::usage, message("'{}' is not a command", as_it_is(word)), std::move(hint));
}

}  // namespace servoctl::cli
