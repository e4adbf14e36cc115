#include "cli/batch/batch_plan.hpp"

#include <fmt/format.h>
#include <map>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "cli/batch/gateway_line.hpp"

namespace servoctl::cli {
namespace {

/// Loops in loops and variables in long lines grow fast: more is a mistake.
constexpr std::size_t kMostTaken = 20'000;
constexpr std::size_t kMostText = 16U << 20U;

class Planner {
 public:
  Planner(Variables variables, const std::filesystem::path& folder)
      : variables_(std::move(variables)), folder_(&folder) {}

  void take(const std::vector<Statement>& statements) {
    for (const auto& statement : statements) {
      if (full_) return;
      if (const auto taken = take(statement); !taken) error(statement.line, taken.error());
    }
  }

  Plan done() {
    plan_.errors = errors_.take();
    return std::move(plan_);
  }

 private:
  Result<void> take(const Statement& statement) {
    if (const auto room = count(); !room) return room;
    switch (statement.kind) {
      case Statement::Kind::command: return command(statement);
      case Statement::Kind::set: return set(statement);
      case Statement::Kind::loop: return loop(statement);
      case Statement::Kind::expect: return expectation(statement);
      case Statement::Kind::pause: return pause(statement);
      case Statement::Kind::wait: return wait(statement);
      case Statement::Kind::on_error: return on_error(statement);
    }
    return {};
  }

  Result<void> count() {
    if (++taken_ <= kMostTaken) return {};
    full_ = true;
    return fail(Errc::usage, message("the loops make more than {} lines", kMostTaken),
                "use one file per machine or group of axes, run one after the other");
  }

  /// What the file has become with its variables filled in and its tables read.
  Result<void> count_text(std::size_t size) {
    text_ += size;
    if (text_ <= kMostText) return {};
    full_ = true;
    return fail(Errc::usage, message("with its variables expanded the file exceeds {} MiB", kMostText >> 20U),
                "is a variable too long?");
  }

  VariableLookup lookup() const {
    return [this](std::string_view name) { return variables_.value(name); };
  }

  Result<std::vector<std::string>> words_of(const Statement& statement) {
    auto words = split_words(statement.text, lookup());
    std::size_t size = 0;
    for (const auto& word : words ? *words : std::vector<std::string>()) size += word.size() + 1;
    if (const auto room = count_text(size); !room) return fail(room.error());
    return words;
  }

  /// A table that stands in a loop is read once.
  Result<std::vector<LoopItem>> items_of(const std::vector<std::string>& words) {
    const auto known = words.size() == 1 ? tables_.find(words.front()) : tables_.end();
    if (known != tables_.end()) return known->second;
    auto items = loop_items(words, *folder_);
    if (items && !items->front().cells.empty()) tables_.emplace(words.front(), *items);
    return items;
  }

  Step& add(const Statement& statement, Step::Kind kind, std::string text) {
    plan_.steps.push_back({kind, statement.line, std::move(text), goes_on_, round()});
    return plan_.steps.back();
  }

  Result<void> command(const Statement& statement) {
    auto words = words_of(statement);
    if (!words) return fail(words.error());
    if (auto translated = from_gateway_line(*words)) words = std::move(*translated);
    if (!words) return fail(words.error());
    if (!words->empty()) add(statement, Step::Kind::command, join_words(*words)).words = std::move(*words);
    return {};
  }

  Result<void> set(const Statement& statement) {
    const auto words = words_of(statement);
    if (!words) return fail(words.error());
    if (words->empty()) return fail(Errc::usage, "'set' needs NAME=VALUE", "set GAIN=45Hz");
    for (const auto& word : *words)
      if (const auto done = variables_.set(word); !done) return done;
    return {};
  }

  Result<void> loop(const Statement& statement) {
    const auto words = words_of(statement);
    if (!words) return fail(words.error());
    const auto items = items_of(*words);
    if (!items) return fail(items.error());
    for (const auto& item : *items) {
      if (full_) break;
      // A round is its lines; one without any still takes its time.
      if (statement.body.empty())
        if (const auto room = count(); !room) return room;
      std::size_t size = item.word.size();
      for (const auto& [column, cell] : item.cells) size += column.size() + cell.size() + 1;
      if (const auto room = count_text(size); !room) return room;
      variables_.forget_row(statement.variable);
      variables_.assign(statement.variable, item.word);
      for (const auto& [column, cell] : item.cells)
        variables_.assign(statement.variable + "." + column, cell);
      rounds_.push_back(statement.variable + "=" + item.name);
      take(statement.body);
      rounds_.pop_back();
    }
    return {};
  }

  Result<void> expectation(const Statement& statement) {
    auto expression = parse_expression(statement.text, lookup());
    if (const auto room = count_text(expression ? to_string(*expression).size() : 0); !room) return room;
    if (!expression) return fail(expression.error());
    add(statement, Step::Kind::expect, "expect " + to_string(*expression)).expression =
        std::move(*expression);
    return {};
  }

  Result<void> pause(const Statement& statement) {
    auto words = words_of(statement);
    if (!words) return fail(words.error());
    add(statement, Step::Kind::pause, "pause " + join_words(*words)).words = std::move(*words);
    return {};
  }

  Result<void> wait(const Statement& statement) {
    const auto words = words_of(statement);
    if (!words) return fail(words.error());
    if (words->size() != 1) return fail(Errc::usage, "'wait' takes a time", "wait 500ms, wait 2s");
    const auto time = read_duration(words->front());
    if (!time) return fail(Errc::usage, "wait: " + time.error().message, time.error().hint);
    add(statement, Step::Kind::wait, "wait " + words->front()).duration = *time;
    return {};
  }

  Result<void> on_error(const Statement& statement) {
    const auto words = words_of(statement);
    if (!words) return fail(words.error());
    if (words->size() != 1 || (words->front() != "stop" && words->front() != "continue"))
      return fail(Errc::usage, "'on-error' takes one word", "write stop or continue");
    goes_on_ = words->front() == "continue";
    return {};
  }

  void error(std::uint32_t line, const Error& what) {
    errors_.add(line, round(), what);
    full_ = full_ || errors_.size() == kMostErrors;
  }

  std::string round() const { return formatted("{}", fmt::join(rounds_, " ")); }

  Variables variables_;
  const std::filesystem::path* folder_;
  Plan plan_;
  LineErrors errors_;
  std::vector<std::string> rounds_;  ///< Of the loops that are open, the outer ones first.
  std::map<std::string, std::vector<LoopItem>> tables_;
  std::size_t taken_ = 0;
  std::size_t text_ = 0;
  bool goes_on_ = false;
  bool full_ = false;
};

}  // namespace

void LineErrors::add(std::uint32_t line, const std::string& round, Error error) {
  if (!told_.insert({line, error.message.text()}).second) return;
  error = in_round(round, std::move(error));
  error.line = line;
  errors_.push_back(std::move(error));
}

Error in_round(const std::string& round, Error error) {
  if (!round.empty()) error.message += " [" + round + "]";
  return error;
}

Plan plan_batch(const Batch& batch, Variables variables, const std::filesystem::path& folder) {
  Planner planner(std::move(variables), folder);
  planner.take(batch.statements);
  return planner.done();
}

}  // namespace servoctl::cli
