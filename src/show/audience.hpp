#pragma once

#include <memory>
#include <string_view>

#include "base/result.hpp"
#include "base/time.hpp"
#include "report/value.hpp"
#include "show/live_view.hpp"

namespace servoctl::show {

/// Who is on the other side of a desk: is asked before what cannot be taken back, and sees what there is to
/// see before the answer. This one is nobody: nobody confirms, nothing is shown.
class Audience {
 public:
  Audience() = default;
  Audience(const Audience&) = delete;
  Audience& operator=(const Audience&) = delete;
  virtual ~Audience() = default;

  /// Asks before something that stores, resets, re-addresses or moves; Errc::refused when the answer is no.
  virtual Result<void> confirm(std::string_view question);
  /// Shows one sample of a command that goes on: the line in text, the record with `-o jsonl`. With `--json`
  /// nothing: the result has to carry the samples.
  virtual void emit(const report::Record& sample, std::string_view line);
  /// Shows many samples at once, rendered already, for commands to which emit() is too slow; see
  /// SampleWriter.
  virtual void write(std::string_view lines);
  /// Shows lines at once where people look (stderr), whatever form the result has.
  virtual void tell(std::string_view text);
  /// One line on a terminal that says where a long wait is; the next one takes its place, and whatever else
  /// is shown wipes it. `now` is on the clock of the bus.
  virtual void show_progress(std::string_view line, TimePoint now);
  /// The same of what is not on the bus of the line: how much of it is done, from 0 to 1, on a clock of its
  /// own.
  virtual void show_share(double share, TimePoint begin, TimePoint now);
  /// Columns of the terminal that it looks at; 0: none, or not known.
  virtual std::size_t width() const { return 0; }
  /// A table that is updated where it stands, until the answer is destroyed; null where samples are lines or
  /// records: no terminal, `--json`, `-o jsonl`.
  virtual std::unique_ptr<LiveView> open_view(const LiveView::Layout& layout);
  /// Whether what emit() shows reaches nobody any more (closed pipe, full disk).
  virtual bool is_gone() const { return false; }
};

}  // namespace servoctl::show
