#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "commands/command.hpp"

namespace servoctl::commands {

/// Gathers the samples of a command that has many of them, and shows them in large pieces: a write for each
/// would cost more than all the rest. Call flush() before every wait.
class SampleWriter {
 public:
  explicit SampleWriter(Context& context) : context_(&context) {}
  ~SampleWriter() { flush(); }
  SampleWriter(const SampleWriter&) = delete;
  SampleWriter& operator=(const SampleWriter&) = delete;

  /// Whether samples are records now; else they are lines of text.
  bool wants_records() const { return context_->wants_records || context_->keeps_samples; }

  void add_line(std::string_view line) {
    lines_ += line;
    lines_ += '\n';
    if (lines_.size() >= kPiece) flush();
  }
  void add_record(report::Record record) {
    if (context_->wants_records) add_line(report::to_json(record));
    if (context_->keeps_samples) kept_.emplace_back(std::move(record));
  }
  void flush() {
    if (!lines_.empty()) context_->write(lines_);
    lines_.clear();
  }
  /// What `--json` keeps for the result.
  report::List take_kept() { return std::move(kept_); }

 private:
  static constexpr std::size_t kPiece = std::size_t{64} << 10U;

  Context* context_;
  std::string lines_;
  report::List kept_;
};

}  // namespace servoctl::commands
