#include "cli/terminal/completer.hpp"

#include <algorithm>

#include "cli/terminal/candidates.hpp"
#include "command/help_text.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"

namespace servoctl::cli {
namespace {

using command::Command;
using command::Kind;
using command::Parameter;

/// A line of which the last word is not ready.
struct BegunLine {
  std::vector<std::string> words;  ///< Those before it.
  std::string last;
  std::size_t typed = 0;  ///< Bytes of the last one as it stands there, with quotes.
};

/// As split_words(), for a line in which a quote may still be open.
BegunLine begun_line(std::string_view line) {
  BegunLine out;
  char quote = 0;
  bool inside = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote == 0 && (c == ' ' || c == '\t')) {
      if (inside) out.words.push_back(std::move(out.last));
      out.last.clear();
      inside = false;
      continue;
    }
    if (!inside) begin = i;
    inside = true;
    if (quote != 0 && c == quote)
      quote = 0;
    else if (quote == 0 && (c == '"' || c == '\''))
      quote = c;
    else if (c == '\\' && quote != '\'' && i + 1 < line.size())
      out.last += line[++i];
    else
      out.last += c;
  }
  out.typed = inside ? line.size() - begin : 0;
  return out;
}

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

std::string family_of(const std::vector<std::string>& words, Shell& shell) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i)
    if (words[i] == "-d" || words[i] == "--drive") return words[i + 1];
  return shell.family_in_use();
}

void add_positional(Candidates& out, const Command& command, const std::vector<std::string>& words,
                    std::size_t at) {
  std::vector<std::string> before;
  for (; at < words.size(); ++at) {
    const auto* option = find_option(&command, words[at]);
    if (option != nullptr && option->kind != Kind::flag)
      ++at;
    else if (option == nullptr)
      before.push_back(words[at]);
  }
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

void add_options(Candidates& out, const Command* command) {
  if (command != nullptr)
    for (const auto& parameter : command->parameters)
      if (parameter.name.starts_with("-")) out.add(parameter.name, parameter.help);
  for (const auto& parameter : command::global_options())
    if (command == nullptr || !command::has_own(*command, parameter)) out.add(parameter.name, parameter.help);
}

void add_all(Candidates& out, const std::vector<std::string>& words, const std::string& last) {
  if (add_prompt_words(out, words)) return;
  const auto match = match_command(words);
  const auto* option = words.empty() ? nullptr : find_option(match.command, words.back());
  if (option != nullptr && option->kind != Kind::flag) return out.add_values(match.command, *option, {});
  if (!last.empty() && last.front() == '-') add_options(out, match.command);
  if (match.command == nullptr) return out.add_commands(words, match.first);
  add_positional(out, *match.command, words, match.first + match.used);
  // `test` is a command, and the first word of others.
  if (words.size() == match.first + match.used) out.add_commands(words, match.first);
}

}  // namespace

Offer complete(std::string_view line, Shell& shell) {
  const auto begun = begun_line(line);
  Candidates found(begun.last, shell, family_of(begun.words, shell));
  add_all(found, begun.words, begun.last);
  Offer out{.typed = begun.typed, .candidates = found.take(), .note = found.note()};
  for (auto& one : out.candidates)
    if (one.word.find_first_of(kNotPlain) != std::string::npos) one.word = as_word(one.word);
  return out;
}

}  // namespace servoctl::cli
