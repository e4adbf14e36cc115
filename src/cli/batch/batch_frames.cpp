#include "cli/batch/batch_frames.hpp"

#include <algorithm>

#include "cli/batch/batch_run.hpp"
#include "cli/terminal/prompt_words.hpp"

namespace servoctl::cli {
namespace {

using report::List;
using report::Record;
using report::Table;
using report::Value;

/// The cell of a column, or nothing.
Value cell(const Table& table, const List& row, std::string_view key) {
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    if (table.columns[i].key == key) return row[i];
  return {};
}

bool has_column(const Table& table, std::string_view key) {
  return std::any_of(table.columns.begin(), table.columns.end(),
                     [&](const Table::Column& column) { return column.key == key; });
}

/// The rows of all tables with a column of frames, or of values where there are no frames, wherever a command
/// put them.
void find_frames(const Value& value, List node, List& out) {
  if (const auto* list = std::get_if<List>(&value.data()))
    for (const auto& element : *list) find_frames(element, node, out);
  if (const auto* record = std::get_if<Record>(&value.data())) {
    if (const auto* frame = report::find(value, "frame")) out.push_back(List{{}, {}, {}, {}, *frame, {}});
    if (const auto* number = report::find(value, "node")) node = {*number};
    for (const auto& field : *record) find_frames(field.value, node, out);
  }
  const auto* table = value.table();
  if (table == nullptr) return;
  const bool has_frames = has_column(*table, "frame");
  const bool has_values = has_column(*table, "value") && has_column(*table, "when");
  if (!has_frames && !has_values) return;
  for (const auto& row : table->rows) {
    auto number = cell(*table, row, "node");
    if (number.is_null() && !node.empty()) number = node.front();
    auto name = cell(*table, row, "name");
    if (name.is_null()) name = cell(*table, row, "step");
    auto frame = cell(*table, row, "frame");
    auto written = has_values && frame.is_null() ? cell(*table, row, "value") : Value();
    out.push_back(List{number, cell(*table, row, "object"), name, cell(*table, row, "when"), std::move(frame),
                       std::move(written)});
  }
}

bool sends_something(const std::vector<std::string>& words) {
  const auto parsed = parse_line(words);
  return parsed && parsed->command->effect_with(parsed->arguments) >= command::Effect::writes;
}

class Frames {
 public:
  Frames(Shell& shell, const std::string& file) : shell_(&shell), file_(&file) {
    table_.columns = {{"line"}, {"text", "what is run"}, {"node"}, {"object"}, {"name"}, {"when"}, {"frame"},
                      {"value"}};
  }

  void take(const Step& step) {
    List frames;
    if (step.kind == Step::Kind::command && !is_exit(step.words)) {
      if (auto chosen = choose(*shell_, step.words))
        take_remarks(step, *chosen);
      else if (sends_something(step.words))
        frames = frames_of(step);
    }
    if (frames.empty()) table_.rows.push_back({step.line, step.text, {}, {}, {}, {}, {}, {}});
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const auto& row = std::get<List>(frames[i].data());
      table_.rows.push_back(
          {step.line, i == 0 ? Value(step.text) : Value(""), row[0], row[1], row[2], row[3], row[4], row[5]});
    }
  }

  Outcome take_all(Settings settings) {
    return {.command = "run",
            .settings = std::move(settings),
            .uses_bus = true,
            .result = std::move(table_),
            .errors = std::move(errors_),
            .notices = std::move(notices_)};
  }

 private:
  List frames_of(const Step& step) {
    auto outcome = shell_->perform(step.words);
    take_remarks(step, outcome);
    List out;
    find_frames(outcome.result, {}, out);
    return out;
  }

  void take_remarks(const Step& step, Outcome& outcome) {
    for (auto& error : outcome.errors)
      errors_.push_back(at_line(*file_, step.line, in_round(step.round, std::move(error))));
    for (auto& notice : outcome.notices)
      if (std::find(notices_.begin(), notices_.end(), notice) == notices_.end())
        notices_.push_back(std::move(notice));
  }

  Shell* shell_;
  const std::string* file_;
  Table table_;
  std::vector<Error> errors_;
  std::vector<Message> notices_;
};

}  // namespace

Outcome planned_frames(Shell& shell, std::span<const Step> steps, const std::string& file) {
  const auto settings = shell.defaults();
  Frames frames(shell, file);
  for (const auto& step : steps) {
    if (shell.cancelled()) break;
    frames.take(step);
  }
  return frames.take_all(settings);
}

}  // namespace servoctl::cli
