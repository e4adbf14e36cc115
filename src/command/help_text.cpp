#include "command/help_text.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"
#include "report/catalogue.hpp"

namespace servoctl::command {
namespace {

std::string option_words(const Parameter& parameter) {
  std::string out =
      parameter.short_name.empty() ? std::string("    ") : std::string(parameter.short_name) + ", ";
  out += parameter.name;
  if (parameter.kind != Kind::flag) out += " " + value_word(parameter);
  return out;
}

/// The pages, in a language and so many columns wide.
class HelpPage {
 public:
  HelpPage(std::size_t width, bool chinese) : width_(width), chinese_(chinese) {}

  std::string of(const Command& command) const {
    auto out = formatted("{}\n\n{}\n", wrapped("servoctl " + usage_line(command.path), 4, width_),
                         sentence(command.summary));
    if (!command.details.empty()) out += "\n" + wrapped(said(command.details), 0, width_) + "\n";
    if (const auto words = rows(command.parameters, false); !words.empty())
      out += "\n" + said("Arguments:") + "\n" + words;
    if (const auto options = rows(command.parameters, true); !options.empty())
      out += "\n" + said("Options:") + "\n" + options;
    out += example_lines(command.examples);
    std::vector<Parameter> others(global_options().begin(), global_options().end());
    std::erase_if(others, [&](const Parameter& global) { return has_own(command, global); });
    return out + "\n" + said("Options of every command:") + "\n" + rows(others, true);
  }

  std::string of(const PromptWord& word) const {
    const auto group = command_rows(word.name);
    return formatted("{} {}\n\n{}\n\n{}\n{}{}", said("At the prompt:"), prompt_usage(word),
                     sentence(word.summary), wrapped(said(word.details), 0, width_),
                     example_lines(word.examples),
                     group.empty() ? "" : formatted("\nservoctl {} …\n\n{}", word.name, group));
  }

  /// What it does, and for which commands, where that differs; empty where none has it.
  std::string of_option(std::string_view name) const {
    std::vector<std::pair<const Parameter*, std::string>> found;
    const auto look = [&](std::span<const Parameter> parameters, std::string_view command) {
      for (const auto& one : parameters) {
        if (one.name != name && (one.short_name.empty() || one.short_name != name)) continue;
        auto same = std::find_if(found.begin(), found.end(),
                                 [&](const auto& each) { return each.first->help == one.help; });
        if (same == found.end()) same = found.insert(found.end(), {&one, {}});
        append(same->second, command);
      }
    };
    look(global_options(), {});
    for (const auto* command : registry()) look(command->parameters, command->path);
    std::string out;
    for (const auto& [parameter, commands] : found) {
      const auto heading = commands.empty() ? "Options of every command:" : "Options:";
      out += (out.empty() ? "" : "\n") + said(heading) + "\n" + rows(std::span(parameter, 1), true);
      if (!commands.empty()) out += row("", commands);
    }
    return out;
  }

  std::string of_program() const {
    return wrapped(said("servoctl: commissions CANopen servo drives from a terminal"), 2, width_) + "\n\n" +
           usage("  servoctl [OPTIONS] COMMAND …    ", "run one command") +
           usage("  servoctl [OPTIONS]              ", "the prompt; also reads command lines from a pipe") +
           usage("  servoctl [OPTIONS] -            ", "a batch file from standard input (see `help run`)") +
           "\n" + said("Commands:") + "\n" + command_rows({}) + "\n" + said("At the prompt also:") + "\n" +
           word_rows() + "\n" + said("Options of every command:") + "\n" + rows(global_options(), true) +
           "\n" + end() + "\n";
  }

  std::string command_rows(std::string_view group) const {
    std::size_t longest = 0;
    for (const auto* command : registry()) longest = std::max(longest, command->path.size());
    std::string out;
    for (const auto* command : registry())
      if (group.empty() || command->path.starts_with(std::string(group) + " "))
        out += "  " + pad_right(command->path, longest) + "  " +
               wrapped(said(command->summary), longest + 4, width_) + "\n";
    return out;
  }

 private:
  std::string said(std::string_view text) const {
    return chinese_ ? report::in_chinese(text) : std::string(text);
  }

  /// With its full stop.
  std::string sentence(std::string_view text) const {
    return wrapped(said(text) + (chinese_ ? "。" : "."), 0, width_);
  }

  std::string usage(std::string_view line, std::string_view what) const {
    if (display_width(line) + display_width(said(what)) <= width_)
      return std::string(line) + said(what) + "\n";
    return std::string(line.substr(0, line.find_last_not_of(' ') + 1)) + "\n      " +
           wrapped(said(what), 6, width_) + "\n";
  }

  std::string end() const {
    constexpr std::string_view kEnd =
        "`help COMMAND` shows more, with examples. Exit codes: 0 done, 1 negative result, 2 usage, 3 bus, 4 no "
        "answer, 5 refused by the drive, 6 protocol error, 7 file, 8 refused for safety, 70 a bug, 130 Ctrl-C.";
    return wrapped(said(kEnd), 0, width_);
  }

  std::string rows(std::span<const Parameter> parameters, bool options) const {
    std::string out;
    for (const auto& parameter : parameters) {
      if (parameter.name.starts_with("-") != options) continue;
      const auto left = options ? option_words(parameter) : value_word(parameter);
      out += row(left, parameter.help);
    }
    return out;
  }

  /// Each line as it is typed, and under it what it is for.
  std::string example_lines(std::span<const Example> examples) const {
    if (examples.empty()) return {};
    auto out = "\n" + said("Examples:") + "\n";
    for (const auto& example : examples)
      out += formatted("  {}\n      {}\n", example.line, wrapped(said(example.what), 6, width_));
    return out;
  }

  std::string word_rows() const {
    std::string out;
    for (const auto& word : prompt_words()) out += row(prompt_usage(word), word.summary);
    return out;
  }

  /// What it is stands behind it, or below what is too long for that.
  std::string row(const std::string& left, std::string_view what) const {
    constexpr std::size_t kLeft = 22;
    constexpr std::size_t kIndent = kLeft + 3;
    const auto right = wrapped(said(what), kIndent, width_) + "\n";
    return display_width(left) > kLeft ? "  " + left + "\n" + std::string(kIndent, ' ') + right
                                       : "  " + pad_right(left, kLeft) + " " + right;
  }

  std::size_t width_;
  bool chinese_;
};

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

Result<std::string> help_text(std::string_view path, std::size_t width, bool chinese) {
  const auto columns = width == 0 ? std::size_t{100} : std::clamp<std::size_t>(width, 40, 120);
  const HelpPage page(columns, chinese);
  if (path.empty()) return page.of_program();
  if (const auto* command = find_command(path)) return page.of(*command);
  if (const auto* word = find_prompt_word(path)) return page.of(*word);
  if (const auto group = page.command_rows(path); !group.empty())
    return formatted("servoctl {} …\n\n{}", path, group);
  if (auto option = path.starts_with('-') ? page.of_option(path) : std::string(); !option.empty())
    return option;
  std::vector<std::string> names;
  for (const auto* command : registry()) names.emplace_back(command->path);
  for (const auto& word : prompt_words()) names.emplace_back(word.name);
  auto hint = did_you_mean(path, names);
  return fail(Errc::usage, message("'{}' is not a command", as_it_is(path)),
              hint.empty() ? "`help` lists the commands" : std::move(hint));
}

}  // namespace servoctl::command
