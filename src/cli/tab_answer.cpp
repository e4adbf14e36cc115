#include "cli/tab_answer.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "cli/terminal/begun_line.hpp"
#include "cli/terminal/completer.hpp"
#include "report/catalogue.hpp"

namespace servoctl::cli {
namespace {

using Words = std::vector<std::string>;

/// What may be offered, and what the first line of the answer says.
struct Tab {
  std::string head;
  std::vector<Candidate> candidates;
};

/// What goes on behind it: a URL, a folder, an assignment.
bool word_goes_on(std::string_view word) {
  return !word.empty() && std::string_view("/:=@").find(word.back()) != std::string_view::npos;
}

/// As the shell does before the program sees it.
void enter_home(Words& words) {
  const char* home = std::getenv("HOME");
  if (home == nullptr) return;
  for (auto& word : words)
    if (word.starts_with("~/")) word.replace(0, 1, home);
}

/// `lists_files`: those are told as any word, and not left to the shell.
Tab find_words(Words words, const std::string& begun, Shell& shell, bool lists_files) {
  enter_home(words);
  auto found = complete_in_shell(words, begun, shell);
  if (lists_files && found.any_file()) found.add_files();
  Tab out{.head = "words", .candidates = found.take()};
  // Names come from files: one that looks like an option is not put where none was begun.
  if (!begun.starts_with('-'))
    std::erase_if(out.candidates, [](const Candidate& one) { return one.word.starts_with('-'); });
  prefer_exact(out.candidates, begun);
  for (auto& one : out.candidates) one.hint = printable(one.hint);
  if (found.any_file() && !lists_files && out.candidates.empty())
    out.head = "files";
  else if (out.candidates.empty() && !found.note().empty())
    out.head = "note " + printable(found.note());
  else if (out.candidates.size() == 1 && word_goes_on(out.candidates.front().word))
    out.head = "open";
  return out;
}

std::string in_lines(const Tab& tab, const std::vector<std::string>& lines) {
  auto out = tab.head;
  for (const auto& line : lines) out += "\n" + line;
  return out;
}

/// `word<tab>what it is`.
std::string for_fish(const Tab& tab) {
  std::vector<std::string> lines;
  for (const auto& one : tab.candidates)
    lines.push_back(one.hint.empty() ? one.word : one.word + "\t" + one.hint);
  return in_lines(tab, lines);
}

/// What zsh calls the group, and what stands above it.
struct Heading {
  Candidate::Group group;
  std::string_view tag;
  std::string_view english;
};
constexpr Heading kHeadings[] = {{Candidate::Group::commands, "commands", "commands and groups"},
                                 {Candidate::Group::places, "places", "nodes and axes"},
                                 {Candidate::Group::parameters, "parameters", "panel parameters"},
                                 {Candidate::Group::objects, "objects", "objects"},
                                 {Candidate::Group::values, "values", "values"},
                                 {Candidate::Group::options, "options", "options"}};

/// As _describe reads it, `word:what it is`; before it its group, and a `+` where the word goes on, else a
/// `-`. A line `=commands heading` for each group first.
std::string for_zsh(const Tab& tab, bool chinese) {
  std::vector<std::string> lines;
  for (const auto& heading : kHeadings) {
    const bool any = std::any_of(tab.candidates.begin(), tab.candidates.end(),
                                 [&](const Candidate& one) { return one.group == heading.group; });
    if (any)
      lines.push_back(
          formatted("={} {}", heading.tag,
                    chinese ? report::in_chinese(heading.english) : std::string(heading.english)));
  }
  for (const auto& one : tab.candidates) {
    const auto* heading = std::find_if(std::begin(kHeadings), std::end(kHeadings),
                                       [&](const Heading& each) { return each.group == one.group; });
    auto word = formatted("{}{}", heading->tag, word_goes_on(one.word) ? "+" : "-");
    for (const char c : one.word) word += c == ':' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    lines.push_back(one.hint.empty() ? word : word + ":" + one.hint);
  }
  return in_lines(tab, lines);
}

/// bash lists what it may put in, with nothing beside it. Where it only lists ($COMP_TYPE `?`), or finds how
/// far all begin alike (`!`, `@`), what they are may stand behind them.
void add_hints(std::vector<std::string>& entries, const std::vector<Candidate>& candidates, char type,
               std::size_t columns) {
  /// From here on bash asks before it lists, and words in columns can be looked through.
  constexpr std::size_t kMostRows = 100;
  const bool any =
      std::any_of(candidates.begin(), candidates.end(), [](auto& one) { return !one.hint.empty(); });
  if (entries.size() < 2 || entries.size() > kMostRows || !any || columns < 20) return;
  if (std::string_view("?!@").find(type) == std::string_view::npos) return;
  std::size_t widest = 0;
  for (const auto& entry : entries) widest = std::max(widest, display_width(entry));
  widest = std::min(widest, columns / 2);
  std::vector<Candidate> plain;
  std::vector<Candidate> full;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    plain.push_back({entries[i]});
    // Wide enough that each has a row of its own.
    full.push_back({pad_right(clip(pad_right(entries[i], widest) + "  " + candidates[i].hint, columns - 3),
                              columns / 2)});
  }
  if (type != '?' && common_beginning(plain) != common_beginning(full)) return;
  for (std::size_t i = 0; i < entries.size(); ++i) entries[i] = std::move(full[i].word);
}

std::string for_bash(std::span<const std::string> question, Shell& shell) {
  const auto type = parse_digits(question[0], 10).value_or(0);
  const auto columns = parse_digits(question[1], 10).value_or(0);
  auto line = begun_line(question[3], question[2], LineSyntax::bash);
  if (line.words.empty() || line.comment) return {};
  line.words.erase(line.words.begin());
  const auto tab = find_words(line.words, line.last, shell, false);
  std::vector<std::string> entries;
  for (const auto& one : tab.candidates) {
    // What was typed as `~/` stays that.
    const std::size_t home = line.kept == 0 && line.quote == 0 && one.word.starts_with("~/") ? 2 : 0;
    const auto piece = std::string_view(one.word).substr(std::min(line.kept, one.word.size()));
    entries.push_back(std::string(piece.substr(0, home)) + bash_text(piece.substr(home), line.quote));
  }
  add_hints(entries, tab.candidates, type == 0 || type > 127 ? '\t' : static_cast<char>(type),
            static_cast<std::size_t>(columns));
  return in_lines(tab, entries);
}

}  // namespace

std::string bash_text(std::string_view text, char quote) {
  constexpr std::string_view kNotPlain = " \t\"'\\$`&|;<>()[]{}*?!~^#";
  constexpr std::string_view kInDouble = "\"\\$`";
  std::string out;
  for (const char c : text) {
    // Within double quotes bash would look for it in its history, and a backslash stays.
    if (quote == '"' && c == '!') {
      out += "\"\\!\"";
      continue;
    }
    if (quote == '\'' && c == '\'')
      out += "'\\'";
    else if (quote != '\'' && (quote == '"' ? kInDouble : kNotPlain).find(c) != std::string_view::npos)
      out += '\\';
    out += c;
  }
  return out;
}

std::string answer_tab(std::span<const std::string> question, Shell& shell) {
  if (question.size() == 5 && question[0] == "bash") return for_bash(question.subspan(1), shell);
  if (question.size() < 2) return {};
  const Words words(question.begin() + 2, question.end());
  // fish quotes what it is given, but completes paths of a word only once its quotes are taken away.
  const bool fish = question[0] == "fish";
  const auto begun = begun_line(question[1], {}, fish ? LineSyntax::fish : LineSyntax::zsh);
  const auto tab = find_words(words, begun.last, shell, fish);
  if (fish) return for_fish(tab);
  return question[0] == "zsh" ? for_zsh(tab, shell.defaults().chinese) : std::string();
}

}  // namespace servoctl::cli
