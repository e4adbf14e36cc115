#include "cli/line_runner.hpp"

#include <fmt/format.h>

#include "cli/words.hpp"

namespace servoctl::cli {

std::vector<PromptWord> prompt_words() {
  return {{"use", "NODE", "take this node, list or `all` for the lines that follow"},
          {"drive", "FAMILY", "take this drive family for the lines that follow"},
          {"bus", "URL", "go to this bus"},
          {"exit", "", "leave (also quit, or Ctrl-D)"}};
}

int LineRunner::run(std::string_view line) {
  const auto words = split_words(line);
  if (!words) return shell_->report_error(words.error(), shell_->defaults().json);
  if (words->empty()) return 0;
  const auto& first = words->front();
  if (words->size() == 1 && (first == "exit" || first == "quit")) {
    exit_ = true;
    return 0;
  }
  if (words->size() == 2 && first == "use") return use((*words)[1]);
  if (words->size() == 2 && first == "drive") return drive((*words)[1]);
  if (words->size() == 2 && first == "bus") return bus((*words)[1]);
  for (const auto& word : prompt_words())
    if (first == word.name && !word.argument.empty()) {
      Error error;
      error.code = Errc::usage;
      error.message = fmt::format("'{}' takes one word", first);
      error.hint = fmt::format("{} {}: {}", word.name, word.argument, word.help);
      return shell_->report_error(error, shell_->defaults().json);
    }
  return shell_->run(*words);
}

int LineRunner::use(const std::string& nodes) {
  const auto parsed = parse_nodes(nodes);
  if (!parsed) return shell_->report_error(parsed.error(), shell_->defaults().json);
  shell_->defaults().nodes = nodes;
  return 0;
}

int LineRunner::drive(const std::string& family) {
  const auto loaded = shell_->profile(family);
  if (!loaded) return shell_->report_error(loaded.error(), shell_->defaults().json);
  shell_->defaults().drive = family;
  return 0;
}

int LineRunner::bus(const std::string& url) {
  auto settings = shell_->defaults();
  settings.bus = url;
  const auto opened = shell_->open(settings);
  if (!opened) return shell_->report_error(opened.error(), shell_->defaults().json);
  shell_->defaults().bus = url;
  return 0;
}

}  // namespace servoctl::cli
