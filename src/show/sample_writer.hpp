#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "base/printable.hpp"
#include "report/json_writer.hpp"
#include "show/desk.hpp"

namespace servoctl::show {

/// Gathers the samples of a command that has many of them, and shows them in large pieces: a write for each
/// would cost more than all the rest. Call flush() before every wait.
class SampleWriter {
 public:
  explicit SampleWriter(Desk& desk) : desk_(&desk) {}
  ~SampleWriter() { flush(); }
  SampleWriter(const SampleWriter&) = delete;
  SampleWriter& operator=(const SampleWriter&) = delete;

  /// Samples that are lines are rows of this table instead; it outlives the last of them. May be null.
  void show_in(LiveView* view) { view_ = view; }
  LiveView* view() const { return view_; }

  /// Whether samples are records now; else they are lines of text.
  bool wants_records() const { return desk_->wants_records || desk_->keeps_samples; }

  void add_line(std::string_view line) {
    lines_ += printable(line);
    end_line();
  }
  /// Adds a record; `fill` is given a JsonWriter and writes the members.
  template <class Fill>
  void add_record(const Fill& fill) {
    report::JsonWriter json(desk_->keeps_samples ? kept_ : lines_);
    json.begin_record();
    fill(json);
    json.end_record();
    if (!desk_->keeps_samples) end_line();
  }
  void flush() {
    if (!lines_.empty()) desk_->write(lines_);
    lines_.clear();
  }
  /// The list of records that `--json` keeps for the result.
  report::Written take_kept() { return {std::exchange(kept_, "[") + "]"}; }

 private:
  static constexpr std::size_t kPiece = std::size_t{64} << 10U;

  void end_line() {
    lines_ += '\n';
    if (lines_.size() >= kPiece) flush();
  }

  Desk* desk_;
  LiveView* view_ = nullptr;
  std::string lines_;
  std::string kept_ = "[";
};

}  // namespace servoctl::show
