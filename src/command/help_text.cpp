#include "command/help_text.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <vector>

#include "base/text.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"

namespace servoctl::command {
namespace {

std::string upper(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return out;
}

std::string option_words(const Parameter& parameter) {
  std::string out =
      parameter.short_name.empty() ? std::string("    ") : std::string(parameter.short_name) + ", ";
  out += parameter.name;
  if (parameter.kind != Kind::flag) out += " " + value_word(parameter);
  return out;
}

std::string rows(std::span<const Parameter> parameters, bool options, std::size_t width) {
  std::string out;
  for (const auto& parameter : parameters) {
    if (parameter.name.starts_with("-") != options) continue;
    const auto left = options ? option_words(parameter) : value_word(parameter);
    out += "  " + pad_right(left, 22) + " " + wrapped(parameter.help, 25, width) + "\n";
  }
  return out;
}

/// Each line as it is typed, and under it what it is for.
std::string example_lines(std::span<const Example> examples, std::size_t width) {
  if (examples.empty()) return {};
  std::string out = "\nExamples:\n";
  for (const auto& example : examples)
    out += fmt::format("  {}\n      {}\n", example.line, wrapped(example.what, 6, width));
  return out;
}

std::string command_help(const Command& command, std::size_t width) {
  auto out = fmt::format("servoctl {}\n\n{}.\n", usage_line(command.path), command.summary);
  if (!command.details.empty()) out += "\n" + wrapped(command.details, 0, width) + "\n";
  if (const auto words = rows(command.parameters, false, width); !words.empty())
    out += "\nArguments:\n" + words;
  if (const auto options = rows(command.parameters, true, width); !options.empty())
    out += "\nOptions:\n" + options;
  out += example_lines(command.examples, width);
  std::vector<Parameter> others(global_options().begin(), global_options().end());
  std::erase_if(others, [&](const Parameter& global) { return has_own(command, global); });
  return out + "\nOptions of every command:\n" + rows(others, true, width);
}

std::string command_rows(std::string_view group, std::size_t width) {
  std::size_t longest = 0;
  for (const auto* command : registry()) longest = std::max(longest, command->path.size());
  std::string out;
  for (const auto* command : registry())
    if (group.empty() || command->path.starts_with(std::string(group) + " "))
      out += "  " + pad_right(command->path, longest) + "  " + wrapped(command->summary, longest + 4, width) +
             "\n";
  return out;
}

std::string word_help(const PromptWord& word, std::size_t width) {
  const auto group = command_rows(word.name, width);
  return fmt::format("At the prompt: {}\n\n{}.\n\n{}\n{}{}", prompt_usage(word),
                     wrapped(word.summary, 0, width), wrapped(word.details, 0, width),
                     example_lines(word.examples, width),
                     group.empty() ? "" : fmt::format("\nservoctl {} …\n\n{}", word.name, group));
}

std::string word_rows(std::size_t width) {
  std::string out;
  for (const auto& word : prompt_words())
    out += "  " + pad_right(prompt_usage(word), 22) + " " + wrapped(word.summary, 25, width) + "\n";
  return out;
}

std::string program_help(std::size_t width) {
  return "servoctl: commissions CANopen servo drives from a terminal\n\n"
         "  servoctl [OPTIONS] COMMAND …    run one command\n"
         "  servoctl [OPTIONS]              the prompt; also reads command lines from a pipe\n"
         "  servoctl [OPTIONS] -            a batch file from standard input (see `help run`)\n\n"
         "Commands:\n" +
         command_rows({}, width) + "\nAt the prompt also:\n" + word_rows(width) +
         "\nOptions of every command:\n" + rows(global_options(), true, width) +
         "\n`help COMMAND` shows more, with examples. Exit codes: 0 done, 1 negative result, 2 usage, 3 bus, 4 no "
         "answer,\n5 refused by the drive, 6 protocol error, 7 file, 8 refused for safety, 70 a bug, 130 "
         "Ctrl-C.\n";
}

}  // namespace

std::string value_word(const Parameter& parameter) {
  return upper(parameter.name.substr(parameter.name.starts_with("--") ? 2 : 0));
}

std::string usage_line(std::string_view path) {
  const auto* command = find_command(path);
  std::string out(path);
  if (command == nullptr) return out;
  for (const auto& parameter : command->parameters) {
    if (parameter.name.starts_with("-")) continue;
    const auto word = value_word(parameter) + (parameter.many ? "…" : "");
    out += parameter.required ? " " + word : " [" + word + "]";
  }
  return out + " [OPTIONS]";
}

bool has_own(const Command& command, const Parameter& global) {
  return std::any_of(command.parameters.begin(), command.parameters.end(),
                     [&](const Parameter& parameter) { return parameter.name == global.name; });
}

Result<std::string> help_text(std::string_view path, std::size_t width) {
  const auto columns = width == 0 ? std::size_t{100} : std::clamp<std::size_t>(width, 40, 120);
  if (path.empty()) return program_help(columns);
  if (const auto* command = find_command(path)) return command_help(*command, columns);
  if (const auto* word = find_prompt_word(path)) return word_help(*word, columns);
  if (const auto group = command_rows(path, columns); !group.empty())
    return fmt::format("servoctl {} …\n\n{}", path, group);
  std::vector<std::string> names;
  for (const auto* command : registry()) names.emplace_back(command->path);
  for (const auto& word : prompt_words()) names.emplace_back(word.name);
  auto hint = did_you_mean(path, names);
  return fail(Errc::usage, fmt::format("'{}' is not a command", path),
              hint.empty() ? "`help` lists the commands" : std::move(hint));
}

}  // namespace servoctl::command
