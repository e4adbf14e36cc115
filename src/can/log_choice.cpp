#include "can/log_choice.hpp"

#include <algorithm>
#include <array>

#include "base/number.hpp"
#include "base/text.hpp"
#include "can/asc.hpp"
#include "can/candump.hpp"
#include "can/trc.hpp"

namespace servoctl::can {
namespace {

/// Times of candump that count from the first line (-tz) and from the one before (-td) look alike: three
/// digits before the point. In so many lines those of -td go back.
constexpr std::size_t kLinesOfDelta = 32;

bool counts_from_a_line(std::string_view line) {
  const auto open = line.find('(');
  return open != std::string_view::npos && line.find('.') == open + 4;
}

/// `***START DATE AND TIME 21:11:2026 13:59:35:000***`
std::optional<Duration> start_day(std::string_view words) {
  const auto date = words.substr(0, words.find(' '));
  if (const auto day = parse_log_date(date)) return day;
  const auto parts = split(date, ':');
  if (parts.size() != 3) return std::nullopt;
  return parse_log_date(std::string(parts[0]) + '.' + std::string(parts[1]) + '.' + std::string(parts[2]));
}

bool is_open(const LogNumbers& numbers) { return numbers.id_base == 0 || numbers.data_base == 0; }

}  // namespace

bool is_log_remark(std::string_view line) {
  line = trim(line);
  if (line.find_first_of("0123456789") == std::string_view::npos) return true;
  return line.starts_with('#') || line.starts_with("//") || line.starts_with("***") || line.starts_with(';');
}

LogMode read_log_mode(std::string_view line) {
  constexpr std::string_view kStart = "***START DATE AND TIME ";
  constexpr std::array<std::string_view, 2> kDates{"date:", "datum:"};
  LogMode out;
  line = trim(line);
  for (const auto key : kDates)
    if (starts_with_nocase(line, key)) out.day = parse_log_date(trim(line.substr(key.size())));
  if (line.starts_with("***HEX***")) out.base = 16;
  if (line.starts_with("***DEC***")) out.base = 10;
  if (line.starts_with("***RELATIVE MODE***")) out.relative = true;
  if (line.starts_with("***ABSOLUTE MODE***") || line.starts_with("***SYSTEM MODE***")) out.relative = false;
  if (line.starts_with(kStart)) out.day = start_day(trim(line.substr(kStart.size())));
  return out;
}

LogChoice::LogChoice(const ColumnChoice* columns) : choice_(columns) {
  for (const auto& format : log_formats()) candidates_.push_back({LogPattern(format), {}, 0});
}

bool LogChoice::look(std::string_view line) {
  ++lines_;
  if (choice_ == nullptr) {
    trc_ = all_semicolons_ && is_trc(line);
    const auto text = trim(line);
    all_semicolons_ = all_semicolons_ && (text.empty() || text.front() == ';');
    asc_ = is_asc(line);
    if (trc_ || asc_ || look_for_candump(line)) return true;
  }
  if (look_for_mode(line)) return false;
  const bool decided = look_for_columns(line);
  return decided || (choice_ == nullptr && !columns_ && look_for_formats(line));
}

bool LogChoice::look_for_mode(std::string_view line) {
  const auto mode = read_log_mode(line);
  if (mode.base) mode_base_ = *mode.base;
  if (mode.relative) mode_relative_ = *mode.relative;
  if (mode.day) day_ = mode.day;
  return trim(line).starts_with("***");
}

bool LogChoice::look_for_candump(std::string_view line) {
  const auto read = read_candump(line);
  if (read.kind != AscLine::Kind::frame) return false;
  ++candump_;
  if (!counts_from_a_line(line)) return true;
  candump_back_ = candump_back_ || read.frame.time < candump_time_;
  candump_time_ = read.frame.time;
  return candump_back_ || candump_ >= kLinesOfDelta;
}

bool LogChoice::look_for_columns(std::string_view line) {
  constexpr std::size_t kEnoughRows = 16;
  if (!columns_) {
    if (choice_ != nullptr && choice_->by_names())
      columns_ = choice_->by_header(line);
    else if (choice_ == nullptr)
      columns_ = read_column_names(line);
    if (columns_) {
      header_ = lines_;
      return false;
    }
    if (choice_ == nullptr || choice_->by_names() || is_log_remark(line) || names_columns(line)) return false;
    for (const char separator : {'\t', ';', ',', ' '}) {
      split_cells(line, separator, cells_);
      auto columns = choice_->in_order(separator);
      if (cells_.size() < choice_->count() || !place_cells(columns, cells_, row_)) continue;
      // A header line has names where the frames have numbers.
      if (!parse_log_id(row_.id)) continue;
      columns_ = std::move(columns);
      header_ = lines_ - 1;
      break;
    }
    if (!columns_) return false;
  }
  split_cells(line, columns_->separator, cells_);
  if (is_log_remark(line) || !place_cells(*columns_, cells_, row_)) return false;
  column_evidence_.add(row_);
  return ++rows_ >= kEnoughRows ? !is_open(numbers()) : !is_open(columns_->numbers);
}

bool LogChoice::look_for_formats(std::string_view line) {
  if (is_log_remark(line)) return false;
  bool fits = false;
  for (auto& each : candidates_) {
    if (!each.pattern.match(line, row_)) continue;
    ++each.count;
    each.evidence.add(row_);
    fits = true;
    // Words of the tool in the line itself: it can be no other.
    if (!is_open(each.pattern.format().numbers)) return true;
  }
  misfits_ += !fits;
  return false;
}

const LogChoice::Candidate* LogChoice::best() const {
  const auto found = std::max_element(candidates_.begin(), candidates_.end(),
                                      [](const auto& a, const auto& b) { return a.count < b.count; });
  // Prose has words that look like a frame now and then.
  return found->count > misfits_ ? &*found : nullptr;
}

LogChoice::Form LogChoice::form() const {
  if (asc_) return Form::asc;
  if (trc_) return Form::trc;
  if (candump_ > 0) return Form::candump;
  if (columns_) return Form::columns;
  return best() != nullptr ? Form::format : Form::none;
}

std::vector<const LogFormat*> LogChoice::formats() const {
  std::vector<const LogFormat*> out;
  const auto* first = best();
  for (const auto& each : candidates_)
    if (first != nullptr && each.pattern.format().name == first->pattern.format().name)
      out.push_back(&each.pattern.format());
  return out;
}

LogNumbers LogChoice::numbers_before() const {
  auto out = form() == Form::columns ? columns_->numbers
             : best() != nullptr     ? best()->pattern.format().numbers
                                     : LogNumbers();
  if (out.id_base == 0) out.id_base = mode_base_;
  if (out.data_base == 0) out.data_base = mode_base_;
  out.relative = out.relative || mode_relative_;
  return out;
}

LogNumbers LogChoice::numbers() const {
  auto out = numbers_before();
  if (columns_)
    column_evidence_.settle(out);
  else if (best() != nullptr)
    best()->evidence.settle(out);
  return out;
}

bool LogChoice::assumed_data() const {
  if (columns_) return column_evidence_.assumed_data(numbers_before());
  return best() != nullptr && best()->evidence.assumed_data(numbers_before());
}

bool LogChoice::assumed() const {
  if (columns_) return column_evidence_.assumed(numbers_before());
  return best() != nullptr && best()->evidence.assumed(numbers_before());
}

}  // namespace servoctl::can
