#include "cli/hint_place.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <vector>

#include "cli/settings.hpp"
#include "cli/words.hpp"

namespace servoctl::cli {
namespace {

using command::Needs;

struct Place {
  std::string_view option;
  std::string_view short_name;
};
constexpr Place kBus{"--bus", "-b"};
constexpr Place kNode{"--node", "-n"};
constexpr Place kDrive{"--drive", "-d"};
constexpr Place kCabinet{"--cabinet", "--cabinet"};

/// Whether all of the command's words are there: one that is only named has no place.
bool is_whole(const Result<ParsedLine>& named) { return named && named->command != nullptr; }

/// As a shell takes it for one word; the prompt and batch files do too.
std::string quoted(const std::string& word) {
  auto out = join_words(std::vector<std::string>{word});
  const bool special = word.find_first_of("&?*$;|<>()[]{}!#~") != std::string::npos;
  return out == word && special ? "'" + word + "'" : out;
}

/// Where a command is told its bus as a word.
constexpr std::string_view kBusWord = "bus";
/// Behind it stands what mends a finding, in the rows that people read.
constexpr std::string_view kMend = "  mend: ";

/// Whether the command is for nodes that the line does not name, so that the family of the line may not be
/// theirs.
bool is_elsewhere(const ParsedLine& line, const ParsedLine& named) {
  if (!line.arguments.has(kNode.option) || !named.arguments.has(kNode.option)) return false;
  const auto of_line = parse_nodes(line.arguments.text(kNode.option));
  const auto of_hint = parse_nodes(named.arguments.text(kNode.option));
  if (!of_line || !of_hint || of_line->front() == 0) return false;
  return !std::includes(of_line->begin(), of_line->end(), of_hint->begin(), of_hint->end());
}

void add(const Place& place, const ParsedLine& line, const ParsedLine& named,
         std::vector<std::string>& words) {
  if (!line.arguments.has(place.option) || named.arguments.has(place.option)) return;
  words.emplace_back(place.short_name);
  words.push_back(quoted(std::string(line.arguments.text(place.option))));
}

/// The family of the line; of a node that it does not name the reader knows which.
void add_family(const ParsedLine& line, const ParsedLine& named, std::vector<std::string>& words) {
  if (!is_elsewhere(line, named)) return add(kDrive, line, named, words);
  if (line.arguments.has(kDrive.option) && !named.arguments.has(kDrive.option))
    words.insert(words.end(), {"-d", "FAMILY"});
}

std::string placed(std::string_view command, const ParsedLine& line) {
  const auto words = split_words(command);
  if (!words || words->empty() || command.find("…") != std::string_view::npos) return std::string(command);
  const auto named = parse_line(*words);
  if (!is_whole(named)) return std::string(command);
  const auto needs = named->command->needs;
  const bool same = named->command == line.command;
  std::vector<std::string> more;
  if (includes(needs, Needs::node) || same) add(kNode, line, *named, more);
  if (includes(needs, Needs::dictionary)) add_family(line, *named, more);
  if ((includes(needs, Needs::bus) || same) && !named->arguments.has(kBusWord)) add(kBus, line, *named, more);
  if (includes(needs, Needs::bus) || named->command->path.starts_with("cabinet"))
    add(kCabinet, line, *named, more);
  return more.empty() ? std::string(command)
                      : std::string(command) + " " + fmt::to_string(fmt::join(more, " "));
}

/// The line as if it had been for this bus.
ParsedLine at_bus(const ParsedLine& line, const std::string& bus) {
  auto out = line;
  if (!bus.empty() && !out.arguments.has(kBus.option)) out.arguments.add(kBus.option, bus);
  return out;
}

/// What mends the findings of `doctor` is done at their bus. It is put into Chinese before it has a place, as
/// hints are: the catalogue knows it without one.
void place_mends(report::Table& table, const ParsedLine& line, bool chinese) {
  if (table.columns.empty() || table.columns.back().key != "finding") return;
  auto here = line;
  for (auto& row : table.rows) {
    if (row.empty()) continue;
    const auto* bus = std::get_if<std::string>(&row.front().data());
    if (bus != nullptr && !bus->empty()) here = at_bus(line, *bus);
    auto* text = std::get_if<std::string>(&row.back().data());
    if (text == nullptr || !text->starts_with(kMend)) continue;
    *text = with_place(chinese ? report::in_chinese(*text) : *text, here);
  }
  for (auto& document : table.documents) {
    auto* record = std::get_if<report::Record>(&document.data());
    if (record == nullptr) continue;
    std::string bus;
    for (auto& field : *record) {
      auto* text = std::get_if<std::string>(&field.value.data());
      if (text != nullptr && field.key == "bus") bus = *text;
      if (text != nullptr && field.key == "mend") *text = with_place(*text, at_bus(line, bus));
    }
  }
}

}  // namespace

std::string with_place(std::string_view text, const ParsedLine& line) {
  std::string out;
  for (;;) {
    const auto begin = text.find('`');
    const auto end = begin == std::string_view::npos ? begin : text.find('`', begin + 1);
    if (end == std::string_view::npos) return out + std::string(text);
    out += text.substr(0, begin + 1);
    out += placed(text.substr(begin + 1, end - begin - 1), line) + "`";
    text.remove_prefix(end + 1);
  }
}

namespace {

void put_place(Message& message, const ParsedLine& line) {
  const auto within = [&](Message::Argument& argument) {
    if (auto* text = std::get_if<std::string>(&argument)) *text = with_place(*text, line);
  };
  message = Verbatim{message.changed([](std::string_view literal) { return literal; }, within)
                         .text([&](std::string_view command) { return placed(command, line); })};
}

}  // namespace

Outcome with_place(Outcome outcome, const ParsedLine& line) {
  for (auto& error : outcome.errors) put_place(error.hint, line);
  for (auto& notice : outcome.notices) put_place(notice, line);
  if (auto* table = outcome.result.table()) place_mends(*table, line, outcome.told);
  return outcome;
}

}  // namespace servoctl::cli
