#include "cli/batch/batch.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>

#include "base/text.hpp"

namespace servoctl::cli {
namespace {

/// Deeper loops are a mistake, and reading them must not exhaust the stack.
constexpr std::size_t kDeepest = 16;

struct LogicalLine {
  std::uint32_t number = 0;
  std::string text;
};

bool is_comment(std::string_view line) { return trim(line).starts_with("#"); }

/// Whether the line ends in a backslash that no other one takes away.
bool goes_on(std::string_view line) {
  const auto last = line.find_last_not_of('\\');
  const auto backslashes = line.size() - (last == std::string_view::npos ? 0 : last + 1);
  return backslashes % 2 == 1 && !is_comment(line);
}

std::vector<LogicalLine> logical_lines(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::vector<LogicalLine> out;
  std::uint32_t number = 0;
  bool open = false;
  for (auto line : split(text, '\n')) {
    ++number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!open) out.push_back({number, {}});
    // What a line before left open is no comment.
    const bool more = goes_on(line) || (open && goes_on("x" + std::string(line)));
    out.back().text += more ? line.substr(0, line.size() - 1) : line;
    open = more;
  }
  return out;
}

struct Keyword {
  std::string_view word;
  Statement::Kind kind;
};
constexpr std::array kKeywords{
    Keyword{"set", Statement::Kind::set}, Keyword{"expect", Statement::Kind::expect},
    Keyword{"pause", Statement::Kind::pause}, Keyword{"wait", Statement::Kind::wait},
    Keyword{"on-error", Statement::Kind::on_error}};

std::string_view take_word(std::string_view& text) {
  text = trim(text);
  const auto end = std::min(text.find_first_of(" \t"), text.size());
  const auto word = text.substr(0, end);
  text = trim(text.substr(end));
  return word;
}

class BatchParser {
 public:
  Batch parse(std::string_view text) {
    for (const auto& line : logical_lines(text)) take(line);
    while (!open_.empty()) {
      const auto line = open_.back().statement.line;
      close();
      error(line, "'for' has no 'end'", "close the loop with a line `end`");
    }
    return std::move(batch_);
  }

 private:
  void take(const LogicalLine& line) {
    if (is_comment(line.text) || trim(line.text).empty()) return;
    std::string_view rest = line.text;
    const auto word = take_word(rest);
    if (word == "for") return open_loop(line.number, rest);
    if (word == "end" && (rest.empty() || is_comment(rest))) {
      if (open_.empty()) return error(line.number, "'end' without 'for'", {});
      return close();
    }
    add({statement(word, rest, line)});
  }

  static Statement statement(std::string_view word, std::string_view rest, const LogicalLine& line) {
    // `set node 4` and `set network 1` are CiA 309-3.
    auto argument = rest;
    const auto first = take_word(argument);
    const bool gateway = word == "set" && (first == "node" || first == "network");
    for (const auto& keyword : kKeywords)
      if (keyword.word == word && !gateway) return {keyword.kind, line.number, std::string(rest)};
    return {Statement::Kind::command, line.number, std::string(trim(line.text))};
  }

  /// A loop with a wrong head is read to its end all the same, so that what follows is told rightly.
  void open_loop(std::uint32_t number, std::string_view rest) {
    const auto variable = take_word(rest);
    const auto in = take_word(rest);
    const bool head = is_variable_name(variable) && in == "in" && !rest.empty() && !is_comment(rest);
    const bool deep = open_.size() >= kDeepest;
    if (!head) error(number, "'for' needs a name and a list", "for NODE in 1-8, for ROW in axes.csv");
    if (open_.size() == kDeepest) error(number, "loops are nested too deep", {});
    open_.push_back(
        {{Statement::Kind::loop, number, std::string(rest), std::string(variable)}, head && !deep});
  }

  void close() {
    auto loop = std::move(open_.back());
    open_.pop_back();
    // Without its head the body says nothing.
    if (loop.counts) add(std::move(loop.statement));
  }

  void add(Statement statement) {
    (open_.empty() ? batch_.statements : open_.back().statement.body).push_back(std::move(statement));
  }

  void error(std::uint32_t line, std::string message, std::string hint) {
    auto out = make_error(Errc::usage, std::move(message), std::move(hint));
    out.line = line;
    batch_.errors.push_back(std::move(out));
  }

  struct Loop {
    Statement statement;
    bool counts = true;  ///< Its head is right.
  };

  Batch batch_;
  std::vector<Loop> open_;  ///< Loops that are not closed yet, the outer ones first.
};

}  // namespace

bool is_batch_word(std::string_view word) {
  return word == "for" || word == "end" ||
         std::any_of(kKeywords.begin(), kKeywords.end(),
                     [&](const Keyword& one) { return one.word == word; });
}

Batch parse_batch(std::string_view text) { return BatchParser().parse(text); }

bool is_variable_name(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  return !name.empty() && !digit(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || digit(c); });
}

}  // namespace servoctl::cli
