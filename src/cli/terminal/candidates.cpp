#include "cli/terminal/candidates.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <filesystem>

#include "base/printable.hpp"
#include "base/text.hpp"
#include "can/socketcan.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"
#include "drive/topics.hpp"
#include "session/open_port.hpp"
#include "session/open_register_line.hpp"

namespace servoctl::cli {
namespace {

using command::Kind;

/// So many entries of a folder are looked at.
constexpr std::size_t kMostFiles = 5000;

/// Of five thousand words nearly all are ASCII.
bool is_shown_as_it_is(std::string_view word) {
  const bool ascii = std::all_of(word.begin(), word.end(), [](char c) { return c >= ' ' && c <= '~'; });
  return ascii || printable(word) == word;
}

bool begins_hidden(const std::string& name, std::string_view begun) {
  return name.starts_with(".") && !begun.starts_with(".");
}

}  // namespace

Candidates::Candidates(std::string begun, Shell& shell, std::string family)
    : begun_(std::move(begun)),
      shell_(&shell),
      family_(std::move(family)),
      chinese_(shell.defaults().chinese) {}

bool Candidates::fits(std::string_view word) const { return starts_with_nocase(word, begun_); }

void Candidates::add(std::string_view word, std::string_view hint) {
  if (word.empty() || !fits(word) || !is_shown_as_it_is(word)) return;
  if (!known_.emplace(word).second) return;
  out_.push_back({std::string(word), std::string(hint)});
}

const drive::Profile* Candidates::profile() {
  if (family_.empty()) return nullptr;
  const auto loaded = shell_->profile(family_);
  return loaded ? *loaded : nullptr;
}

/// First words of the commands, or the second ones when the first is there.
void Candidates::add_commands(const std::vector<std::string>& words, std::size_t first) {
  const auto typed = words.size() - first;
  for (const auto* command : command::registry()) {
    const auto parts = split(command->path, ' ');
    if (typed >= parts.size()) continue;
    bool goes_on = true;
    for (std::size_t i = 0; i < typed; ++i) goes_on = goes_on && parts[i] == words[first + i];
    if (goes_on) add(parts[typed], parts.size() == typed + 1 ? command->summary : std::string_view("..."));
  }
}

void Candidates::add_families() {
  for (const auto& family : drive::find_families(shell_->drive_folders())) add(family.name);
}

void Candidates::add_buses() {
  for (const auto& interface : can::can_interfaces()) add(interface);
  for (const auto word : {"sim:", "local:", "slcan:/dev/", "socketcand://", "gateway://"}) add(word);
  for (const auto& url : session::ethercat_urls()) add(url);
  for (const auto& url : session::modbus_urls()) add(url);
}

std::string Candidates::heard_of(std::uint8_t node) {
  auto* session = shell_->session();
  std::string out;
  if (session == nullptr) return out;
  if (const auto state = session->watch().state(node)) out = session->network().state_word(*state);
  const auto* identity = session->identities().find(node, session->watch().boots(node));
  if (identity != nullptr && !identity->device_name.empty()) append(out, identity->device_name);
  if (session->watch().boots(node) > 0 && out.empty()) out = "booted";
  return out;
}

void Candidates::add_nodes() {
  // Of a list the last part is completed.
  const auto comma = begun_.rfind(',');
  const auto before = comma == std::string::npos ? std::string() : begun_.substr(0, comma + 1);
  if (before.empty()) add("all", "every node that answers");
  if (const auto cabinet = shell_->cabinet(shell_->defaults()); cabinet && *cabinet != nullptr)
    for (const auto& name : (*cabinet)->names()) add(before + name, "axis of the cabinet");
  const auto used = parse_nodes(shell_->defaults().nodes);
  for (std::uint8_t node = 1; node <= 127; ++node) {
    const auto heard = heard_of(node);
    const bool is_used = used && std::find(used->begin(), used->end(), node) != used->end();
    if (!heard.empty() || is_used) add(before + std::to_string(node), heard.empty() ? "in use" : heard);
  }
}

void Candidates::add_values(const command::Command* command, const command::Parameter& parameter,
                            const std::vector<std::string>& before) {
  for (const auto choice : parameter.choices) add(choice);
  switch (parameter.kind) {
    case Kind::object: return add_objects();
    case Kind::parameter:
      if (command != nullptr && command->path == "param set") return add_assignment(before);
      return add_panel_parameters();
    case Kind::value:
      if (!before.empty()) return add_values_of(before.back());
      break;
    case Kind::family: return add_families();
    case Kind::bus: return add_buses();
    case Kind::nodes: return add_nodes();
    case Kind::topic: return add_topics(before);
    case Kind::file: return add_files();
    case Kind::command:
      if (before.empty())
        for (const auto& word : command::prompt_words()) add(word.name, word.summary);
      return add_commands(before, 0);
    default: break;
  }
  if (command != nullptr) add_known_word(*command, parameter);
}

/// The next word of the names that begin with those before; first also objects and parameters.
void Candidates::add_topics(const std::vector<std::string>& before) {
  const drive::Profile none;
  const auto* known = profile();
  const auto topics = drive::load_topics(known == nullptr ? none : *known, shell_->drive_folders());
  if (!topics) return;
  for (const auto& topic : *topics) {
    const auto words = split(std::string_view(topic.name), ' ');
    if (words.size() > before.size() &&
        std::equal(before.begin(), before.end(), words.begin(),
                   [](const std::string& a, std::string_view b) { return equals_nocase(a, b); }))
      add(words[before.size()]);
  }
  if (before.empty()) add_objects();
}

/// Folders end with a slash: what is in them follows.
void Candidates::add_files() {
  namespace fs = std::filesystem;
  const auto slash = begun_.rfind('/');
  const auto folder = slash == std::string::npos ? std::string() : begun_.substr(0, slash + 1);
  const auto begun = std::string_view(begun_).substr(folder.size());
  std::error_code error;
  fs::directory_iterator at(folder.empty() ? fs::path(".") : fs::path(folder), error);
  for (std::size_t i = 0; !error && at != fs::directory_iterator() && i < kMostFiles;
       at.increment(error), ++i) {
    const auto name = at->path().filename().string();
    std::error_code none;
    if (name.starts_with(begun) && !begins_hidden(name, begun))
      add(folder + name + (at->is_directory(none) ? "/" : ""));
  }
  std::sort(out_.begin(), out_.end(), [](const Candidate& a, const Candidate& b) { return a.word < b.word; });
}

}  // namespace servoctl::cli
