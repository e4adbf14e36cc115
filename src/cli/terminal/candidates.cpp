#include "cli/terminal/candidates.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"
#include "drive/topics.hpp"
#include "report/catalogue.hpp"
#include "show/explanation.hpp"

namespace servoctl::cli {
namespace {

using command::Kind;

/// What is told of more than these nobody lists.
constexpr std::size_t kMostTold = 500;

/// So many entries of a folder are looked at.
constexpr std::size_t kMostFiles = 5000;

/// Of five thousand words nearly all are ASCII.
bool is_shown_as_it_is(std::string_view word) {
  const bool ascii = std::all_of(word.begin(), word.end(), [](char c) { return c >= ' ' && c <= '~'; });
  return ascii || printable(word) == word;
}

/// `list, get, set`: what a first word of several commands goes on with.
std::string second_words(std::string_view first) {
  std::string out;
  for (const auto* command : command::registry())
    if (const auto parts = split(command->path, ' '); parts.size() > 1 && parts.front() == first)
      append(out, parts[1]);
  return out;
}

/// Whether the name has one of these endings, ASCII case ignored; any has none of none.
bool ends_as(std::string_view name, std::span<const std::string_view> endings) {
  return endings.empty() || std::any_of(endings.begin(), endings.end(), [&](std::string_view ending) {
           return name.size() >= ending.size() &&
                  equals_nocase(name.substr(name.size() - ending.size()), ending);
         });
}

/// ASCII case ignored.
bool has_inside(std::string_view text, std::string_view part) {
  return std::search(text.begin(), text.end(), part.begin(), part.end(), [](char a, char b) {
           return equals_nocase({&a, 1}, {&b, 1});
         }) != text.end();
}

bool begins_hidden(const std::string& name, std::string_view begun) {
  return name.starts_with(".") && !begun.starts_with(".");
}

}  // namespace

Candidates::Candidates(std::string begun, Shell& shell, BegunPlace place)
    : begun_(std::move(begun)), shell_(&shell), place_(std::move(place)), chinese_(place_.settings.chinese) {}

Candidates Candidates::behind(std::size_t bytes) const {
  Candidates out(begun_.substr(bytes), *shell_, place_);
  // Of files behind something a shell knows nothing.
  out.place_.in_shell = false;
  return out;
}

void Candidates::take_behind(std::size_t bytes, Candidates value) {
  const auto before = begun_.substr(0, bytes);
  for (const auto& one : value.take()) {
    const auto group = begin_group(one.group);
    add(before + one.word, one.hint);
    begin_group(group);
  }
  note_ = value.note();
}

std::vector<Candidate> Candidates::take() {
  if (chinese_ && out_.size() <= kMostTold)
    for (auto& one : out_) one.hint = told(one.hint);
  return std::move(out_);
}

/// Names of data are in Chinese already.
std::string Candidates::told(const std::string& english) const {
  return chinese_ && !has_chinese(english) ? report::in_chinese(english) : english;
}

bool Candidates::fits(std::string_view word) const { return starts_with_nocase(word, begun_); }

void Candidates::add(std::string_view word, std::string_view hint) {
  if (inside_ && group_ != Candidate::Group::parameters && group_ != Candidate::Group::objects) return;
  const bool taken = inside_ ? has_inside(word, begun_) || has_inside(hint, begun_) : fits(word);
  if (word.empty() || !taken || !is_shown_as_it_is(word)) return;
  if (!known_.emplace(word).second) return;
  out_.push_back({std::string(word), std::string(hint), group_});
}

const drive::Profile* Candidates::profile() {
  if (place_.family.empty()) return nullptr;
  const auto loaded = shell_->profile(place_.family);
  return loaded ? *loaded : nullptr;
}

/// First words of the commands, or the second ones when the first is there.
void Candidates::add_commands(const std::vector<std::string>& words, std::size_t first) {
  const auto typed = words.size() - first;
  const auto group = begin_group(Candidate::Group::commands);
  for (const auto* command : command::registry()) {
    const auto parts = split(command->path, ' ');
    if (typed >= parts.size()) continue;
    bool goes_on = true;
    for (std::size_t i = 0; i < typed; ++i) goes_on = goes_on && parts[i] == words[first + i];
    if (goes_on)
      add(parts[typed],
          parts.size() == typed + 1 ? std::string(command->summary) : second_words(parts.front()));
  }
  begin_group(group);
}

void Candidates::add_values(const command::Command* command, const command::Parameter& parameter,
                            const std::vector<std::string>& before) {
  for (const auto choice : parameter.choices) add(choice);
  add_kind(command, parameter, before);
  if (command != nullptr) add_known_word(*command, parameter);
  if (!out_.empty() || any_file_ || !note_.empty()) return;
  const bool is_name = parameter.kind == Kind::object || parameter.kind == Kind::parameter;
  if (is_name && place_.family.empty())
    note_ = "-d FAMILY before it tells which names there are";
  else if (!parameter.help.empty())
    note_ = formatted("{}: {}", parameter.name, parameter.help);
}

void Candidates::add_kind(const command::Command* command, const command::Parameter& parameter,
                          const std::vector<std::string>& before) {
  switch (parameter.kind) {
    case Kind::object:
      if (command != nullptr && command->path == "pdo map" && !before.empty())
        if (const auto pdo = canopen::parse_pdo_name(before.front())) mapped_ = pdo->direction;
      return add_objects();
    case Kind::parameter:
      if (command != nullptr && command->path == "param set") return add_assignment(before);
      return add_panel_parameters(true);
    case Kind::value:
      if (!before.empty()) return add_values_of(before.back());
      break;
    case Kind::family: return add_families();
    case Kind::bus: return add_buses();
    case Kind::nodes: return add_nodes();
    case Kind::topic: return add_topics(before);
    case Kind::file: any_file_ = place_.in_shell; return place_.in_shell ? void() : add_files();
    case Kind::command:
      if (before.empty())
        for (const auto& word : command::prompt_words()) add(word.name, word.summary);
      return add_commands(before, 0);
    case Kind::duration: return add_durations();
    default: break;
  }
}

/// The next word of the names that begin with those before; first also objects and parameters.
void Candidates::add_topics(const std::vector<std::string>& before) {
  const drive::Profile none;
  const auto* known = profile();
  auto topics = drive::topic_names(known == nullptr ? none : *known, shell_->drive_folders());
  if (!topics) return;
  for (const auto name : {show::kExitCodes, show::kAlStatusCodes}) topics->emplace_back(name);
  for (const auto& topic : *topics) {
    const auto words = split(std::string_view(topic), ' ');
    if (words.size() > before.size() &&
        std::equal(before.begin(), before.end(), words.begin(),
                   [](const std::string& a, std::string_view b) { return equals_nocase(a, b); }))
      add(words[before.size()]);
  }
  if (before.empty()) add_objects();
}

/// What is in a folder follows behind its slash.
void Candidates::add_files(std::span<const std::string_view> endings) {
  namespace fs = std::filesystem;
  const auto slash = begun_.rfind('/');
  const auto folder = slash == std::string::npos ? std::string() : begun_.substr(0, slash + 1);
  const auto begun = std::string_view(begun_).substr(folder.size());
  const bool at_home = place_.in_shell && folder.starts_with("~/");
  const char* home = at_home ? std::getenv("HOME") : nullptr;
  const auto where = home == nullptr ? fs::path(folder) : fs::path(home) / folder.substr(2);
  const auto before = out_.size();
  std::error_code error;
  fs::directory_iterator at(folder.empty() ? fs::path(".") : where, error);
  for (std::size_t i = 0; !error && at != fs::directory_iterator() && i < kMostFiles;
       at.increment(error), ++i) {
    const auto name = at->path().filename().string();
    std::error_code none;
    if (!name.starts_with(begun) || begins_hidden(name, begun)) continue;
    const bool is_folder = at->is_directory(none);
    if (is_folder ? !endings.empty() && begun_.empty() : !ends_as(name, endings)) continue;
    add(folder + name + (is_folder ? "/" : ""));
  }
  std::sort(out_.begin() + static_cast<std::ptrdiff_t>(before), out_.end(),
            [](const Candidate& a, const Candidate& b) { return a.word < b.word; });
}

}  // namespace servoctl::cli
