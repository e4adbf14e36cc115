#include "cli/terminal/completer.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/text.hpp"
#include "can/socketcan.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "command/completion_words.hpp"
#include "command/help_text.hpp"
#include "command/registry.hpp"
#include "drive/naming.hpp"
#include "drive/topics.hpp"
#include "session/open_port.hpp"
#include "session/open_register_line.hpp"

namespace servoctl::cli {
namespace {

using command::Command;
using command::Kind;
using command::Parameter;

/// Words typed before the one that is being completed. Quotes are not looked at: no name has a blank in it.
std::vector<std::string> words_before(std::string_view line, std::string& last) {
  std::vector<std::string> out;
  for (const auto part : split(line, ' '))
    if (!part.empty()) out.emplace_back(part);
  if (!line.empty() && line.back() != ' ' && !out.empty()) {
    last = out.back();
    out.pop_back();
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

class Candidates {
 public:
  Candidates(std::string last, Shell& shell, std::string family)
      : last_(std::move(last)), shell_(&shell), family_(std::move(family)) {}

  void add(std::string_view word) {
    if (starts_with_nocase(word, last_) &&
        std::find(out_.words.begin(), out_.words.end(), word) == out_.words.end())
      out_.words.emplace_back(word);
  }

  void add_values(const Parameter& parameter) {
    for (const auto choice : parameter.choices) add(choice);
    switch (parameter.kind) {
      case Kind::object: return add_objects();
      case Kind::parameter: return add_parameters();
      case Kind::family: return add_families();
      case Kind::bus: return add_buses();
      case Kind::nodes: return add_axes();
      case Kind::topic: return add_topics();
      case Kind::file: out_.files = true; return;
      case Kind::command:
        for (const auto* command : command::registry()) add(split(command->path, ' ').front());
        return;
      default: return;
    }
  }

  void add_families() {
    for (const auto& family : drive::find_families(shell_->drive_folders())) add_name(family.name);
  }
  void add_buses() {
    for (const auto& interface : can::can_interfaces()) add(interface);
    for (const auto word : {"sim:", "local:", "slcan:/dev/", "socketcand://", "gateway://"}) add(word);
    for (const auto& url : session::ethercat_urls()) add(url);
    for (const auto& url : session::modbus_urls()) add(url);
  }

  void add_axes() {
    add("all");
    const auto cabinet = shell_->cabinet(shell_->defaults());
    if (!cabinet || *cabinet == nullptr) return;
    for (const auto& name : (*cabinet)->names()) add_name(name);
  }

  /// What stands before the word, of an argument of several words.
  void set_before(std::vector<std::string> words) { before_ = std::move(words); }

  Completions take() { return std::move(out_); }

 private:
  /// One that comes from a file.
  void add_name(std::string_view name) {
    if (command::can_be_offered(name)) add(name);
  }
  const drive::Profile* profile() {
    if (family_.empty()) return nullptr;
    const auto loaded = shell_->profile(family_);
    return loaded ? *loaded : nullptr;
  }
  void add_objects() {
    if (const auto* known = profile())
      for (const auto& name : drive::names(*known)) add_name(name);
  }
  void add_parameters() {
    if (const auto* known = profile())
      for (const auto& parameter : known->parameters) add_name(parameter.id);
  }
  /// The next word of the names that begin with those before; first also objects and parameters.
  void add_topics() {
    const drive::Profile none;
    const auto* known = profile();
    const auto topics = drive::load_topics(known == nullptr ? none : *known, shell_->drive_folders());
    if (!topics) return;
    for (const auto& topic : *topics) {
      const auto words = split(std::string_view(topic.name), ' ');
      if (words.size() > before_.size() &&
          std::equal(before_.begin(), before_.end(), words.begin(),
                     [](const std::string& a, std::string_view b) { return equals_nocase(a, b); }))
        add_name(words[before_.size()]);
    }
    if (before_.empty()) add_objects();
  }

  std::string last_;
  Shell* shell_;
  std::string family_;
  std::vector<std::string> before_;
  Completions out_;
};

std::string family_of(const std::vector<std::string>& words, Shell& shell) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i)
    if (words[i] == "-d" || words[i] == "--drive") return words[i + 1];
  return shell.defaults().drive;
}

/// First words of the commands, or the second ones when the first is there.
void add_command_words(Candidates& out, const std::vector<std::string>& words, std::size_t first) {
  for (const auto* command : command::registry()) {
    const auto parts = split(command->path, ' ');
    const auto typed = words.size() - first;
    if (typed >= parts.size()) continue;
    bool fits = true;
    for (std::size_t i = 0; i < typed; ++i) fits = fits && parts[i] == words[first + i];
    if (fits) out.add(parts[typed]);
  }
}

void add_positional(Candidates& out, const Command& command, const std::vector<std::string>& words,
                    std::size_t at) {
  std::vector<std::string> before;
  for (; at < words.size(); ++at) {
    const auto* option = find_option(command.parameters, words[at]);
    if (option == nullptr) option = find_option(command::global_options(), words[at]);
    if (option != nullptr && option->kind != Kind::flag)
      ++at;
    else if (option == nullptr)
      before.push_back(words[at]);
  }
  const auto place = before.size();
  out.set_before(std::move(before));
  std::size_t index = 0;
  for (const auto& parameter : command.parameters) {
    if (parameter.name.starts_with("-")) continue;
    if (index == place || (parameter.many && index <= place)) return out.add_values(parameter);
    ++index;
  }
}

bool add_prompt_words(Candidates& out, const std::vector<std::string>& words) {
  if (words.empty()) {
    for (const auto& word : prompt_words()) out.add(word.name);
    return false;
  }
  if (words.size() != 1) return false;
  if (words.front() == "drive") out.add_families();
  if (words.front() == "bus") out.add_buses();
  if (words.front() == "use") out.add_axes();
  return words.front() == "drive" || words.front() == "use";
}

}  // namespace

Completions complete(std::string_view line, Shell& shell) {
  std::string last;
  const auto words = words_before(line, last);
  Candidates out(last, shell, family_of(words, shell));
  if (add_prompt_words(out, words)) return out.take();
  const auto match = match_command(words);
  const std::span<const Parameter> own =
      match.command != nullptr ? match.command->parameters : std::span<const Parameter>();
  if (!words.empty()) {
    const auto* option = find_option(own, words.back());
    if (option == nullptr) option = find_option(command::global_options(), words.back());
    if (option != nullptr && option->kind != Kind::flag) {
      out.add_values(*option);
      return out.take();
    }
  }
  if (!last.empty() && last.front() == '-') {
    for (const auto& parameter : own)
      if (parameter.name.starts_with("-")) out.add(parameter.name);
    for (const auto& parameter : command::global_options())
      if (match.command == nullptr || !command::has_own(*match.command, parameter)) out.add(parameter.name);
    return out.take();
  }
  if (match.command == nullptr)
    add_command_words(out, words, match.first);
  else
    add_positional(out, *match.command, words, match.first + match.used);
  return out.take();
}

}  // namespace servoctl::cli
