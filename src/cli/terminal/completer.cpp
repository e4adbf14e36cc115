#include "cli/terminal/completer.hpp"

#include <algorithm>

#include "base/regular_files.hpp"
#include "cli/terminal/begun_line.hpp"
#include "command/help_text.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"

namespace servoctl::cli {
namespace {

using command::Command;
using command::Kind;
using command::Parameter;

/// What split_words() does not take as it is.
constexpr std::string_view kNotPlain = " \t\"'\\#";

/// The form in which split_words() reads it as one word.
std::string as_word(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view(" \t\"'\\").find(c) != std::string_view::npos || (c == '#' && out.empty()))
      out += '\\';
    out += c;
  }
  return out;
}

const Parameter* find_option(std::span<const Parameter> parameters, std::string_view word) {
  for (const auto& parameter : parameters)
    if (parameter.name.starts_with("-") &&
        (parameter.name == word || (!parameter.short_name.empty() && parameter.short_name == word)))
      return &parameter;
  return nullptr;
}

const Parameter* find_option(const Command* command, std::string_view word) {
  const auto* own = command == nullptr ? nullptr : find_option(command->parameters, word);
  return own != nullptr ? own : find_option(command::global_options(), word);
}

/// How many bytes at the front of the word name an option to which its value is attached: `--bus=can0`,
/// `-bcan0`; 0 where there is none.
std::size_t attached_option(const Command* command, std::string_view word) {
  const auto name = word.starts_with("--") ? word.substr(0, word.find('=')) : word.substr(0, 2);
  const auto* option = name.size() < 2 || name.size() == word.size() ? nullptr : find_option(command, name);
  if (option == nullptr || option->kind == Kind::flag) return 0;
  return name.size() + (word.starts_with("--") ? 1 : 0);
}

/// The words from `at` on that are neither options nor their values.
std::vector<std::string> arguments_in(const Command& command, const std::vector<std::string>& words,
                                      std::size_t at) {
  std::vector<std::string> out;
  bool values_only = false;
  for (; at < words.size(); ++at) {
    const auto* option = values_only ? nullptr : find_option(&command, words[at]);
    if (!values_only && words[at] == "--")
      values_only = true;
    else if (option != nullptr)
      at += option->kind == Kind::flag ? 0U : 1U;
    else if (values_only || attached_option(&command, words[at]) == 0)
      out.push_back(words[at]);
  }
  return out;
}

void add_positional(Candidates& out, const Command& command, const std::vector<std::string>& words,
                    std::size_t at, bool nodes_typed) {
  const auto before = arguments_in(command, words, at);
  const bool takes_axis = includes(command.needs, command::Needs::node) && !nodes_typed;
  if (takes_axis && at == words.size()) out.add_axes();
  std::size_t index = 0;
  for (const auto& parameter : command.parameters) {
    if (parameter.name.starts_with("-")) continue;
    if (index == before.size() || (parameter.many && index <= before.size()))
      return out.add_values(&command, parameter, before);
    ++index;
  }
}

bool add_prompt_words(Candidates& out, const std::vector<std::string>& words) {
  if (words.empty()) {
    for (const auto& word : command::prompt_words()) out.add(word.name, word.summary);
    return false;
  }
  if (words.size() == 2 && words[0] == "log" && words[1] == "on") {
    out.add_values(nullptr, {.name = "file", .help = {}, .kind = Kind::file}, {});
    return true;
  }
  if (words.size() != 1) return false;
  if (words.front() == "drive") out.add_families();
  if (words.front() == "bus") out.add_buses();
  if (words.front() == "use") out.add_nodes();
  if (words.front() == "log")
    for (const auto* word : {"on", "off"}) out.add(word);
  return words.front() == "drive" || words.front() == "use" || words.front() == "log";
}

/// The long names; a short one that is there already stands for itself.
void add_options(Candidates& out, const Command* command, const std::string& last) {
  if (const auto* known = find_option(command, last); known != nullptr && known->short_name == last)
    return out.add(last, known->help);
  if (command != nullptr)
    for (const auto& parameter : command->parameters)
      if (parameter.name.starts_with("-")) out.add(parameter.name, parameter.help);
  for (const auto& parameter : command::global_options())
    if (command == nullptr || !command::has_own(*command, parameter)) out.add(parameter.name, parameter.help);
}

void add_all(Candidates& out, const std::vector<std::string>& words, const std::string& last,
             bool nodes_typed) {
  const auto match = match_command(words);
  const bool values_only = std::find(words.begin(), words.end(), "--") != words.end();
  const auto* option = words.empty() || values_only ? nullptr : find_option(match.command, words.back());
  if (option != nullptr && option->kind != Kind::flag) return out.add_values(match.command, *option, {});
  if (const auto name = values_only ? 0 : attached_option(match.command, last); name != 0) {
    auto value = out.behind(name);
    const auto end = last.starts_with("--") ? name - 1 : name;
    value.add_values(match.command, *find_option(match.command, last.substr(0, end)), {});
    return out.take_behind(name, std::move(value));
  }
  if (!last.empty() && last.front() == '-' && !values_only) {
    const auto group = out.begin_group(Candidate::Group::options);
    add_options(out, match.command, last);
    out.begin_group(group);
  }
  if (match.command == nullptr) return out.add_commands(words, match.first);
  const auto after = match.first + match.used;
  add_positional(out, *match.command, words, after, nodes_typed);
  // `test` is a command, and the first word of others.
  if (words.size() == after) out.add_commands(words, match.first);
}

/// A line that no command begins may begin with a parameter, as as_parameter_line() takes it.
void add_assignments(Candidates& out) {
  const auto* command = command::find_command("param set");
  if (command != nullptr) out.add_values(command, command->parameters.front(), {});
}

/// What one letter is in, is too much to be listed.
constexpr std::size_t kLeastInside = 2;

}  // namespace

Offer complete(std::string_view line, Shell& shell) {
  const RegularFilesOnly regular;
  const auto begun = begun_line(line);
  if (begun.comment) return {};
  const auto words = shell.name_axes(begun.words, match_command(begun.words));
  const auto place = begun_place(words, shell);
  Candidates found(begun.last, shell, place);
  if (!add_prompt_words(found, words)) add_all(found, words, begun.last, place.settings.nodes_typed());
  Offer out{.typed = begun.typed, .candidates = found.take(), .note = found.note()};
  if (out.candidates.empty() && words.empty() && !begun.last.empty()) {
    add_assignments(found);
    out.candidates = found.take();
  }
  if (out.candidates.empty() && !words.empty() && begun.last.size() >= kLeastInside) {
    Candidates inside(begun.last, shell, place);
    inside.match_inside();
    add_all(inside, words, begun.last, place.settings.nodes_typed());
    out.candidates = inside.take();
    out.inside = true;
  }
  prefer_exact(out.candidates, begun.last);
  for (auto& one : out.candidates)
    if (one.word.find_first_of(kNotPlain) != std::string::npos) one.word = as_word(one.word);
  return out;
}

Candidates complete_in_shell(const std::vector<std::string>& words, const std::string& begun, Shell& shell) {
  const RegularFilesOnly regular;
  const auto named = shell.name_axes(words, match_command(words));
  auto place = begun_place(named, shell);
  place.in_shell = true;
  Candidates out(begun, shell, place);
  const auto group = out.begin_group(Candidate::Group::options);
  if (named.empty()) out.add("--version", "show the version");
  out.begin_group(group);
  add_all(out, named, begun, place.settings.nodes_typed());
  return out;
}

}  // namespace servoctl::cli
