#pragma once

#include <cstddef>
#include <optional>

#include "base/time.hpp"
#include "cli/terminal/console.hpp"

namespace servoctl::cli {

/// Tells on a terminal how far a long transfer, or a long list of them, has come: not in its first 300 ms,
/// then ten times a second.
class Progress {
 public:
  explicit Progress(Console& console) : console_(&console) {}

  /// `done` bytes of `total`, when that is known. `now` is on the clock of the bus.
  void update(std::size_t done, std::optional<std::size_t> total, TimePoint now);
  /// The same for `done` objects of `total`.
  void update_list(std::size_t done, std::size_t total, TimePoint now);
  /// Wipes the line.
  void end();

 private:
  /// Whether it is time to say something.
  bool is_due(TimePoint now);

  Console* console_;
  std::optional<TimePoint> begin_;
  TimePoint next_{};
  bool shown_ = false;
};

}  // namespace servoctl::cli
