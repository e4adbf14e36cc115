#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "base/time.hpp"
#include "cli/terminal/console.hpp"
#include "session/stretch.hpp"

namespace servoctl::cli {

/// Tells on a terminal how far a line has come: not in its first 300 ms, then ten times a second. A long
/// transfer, or a long list of them, shows how much of it is done and how long it will go on; a wait of known
/// length the same; what has no known end how long it has been going on.
class Progress {
 public:
  explicit Progress(Console& console) : console_(&console) {}

  /// `done` bytes of `total`, when that is known. `now` is on the clock of the bus.
  void update(std::size_t done, std::optional<std::size_t> total, TimePoint now);
  /// The same for `done` parts of `total`, objects or nodes.
  void update_list(std::size_t done, std::size_t total, TimePoint now);
  /// The same in words.
  void update_line(std::string_view line, TimePoint now);
  /// What goes on while nobody tells more: not beside what the others told, and without a known end not
  /// beside what the line itself shows. `stretch` may be null. Nothing outside of a line.
  void update_wait(const session::Stretch* stretch, TimePoint now);
  /// As a wait of which so much is done, from 0 to 1.
  void update_share(double share, TimePoint begin, TimePoint now);
  /// The line shows something of its own.
  void note_output() { spoke_ = true; }
  /// A line is run; lines in it count on their own.
  void begin() { ++lines_; }
  void leave() { --lines_; }
  /// Wipes it; what comes next begins anew.
  void end();

 private:
  /// Whether it is time to say something.
  bool is_due(TimePoint now);
  void show(std::string line, const std::string& left);
  void show_share(double share, TimePoint begin, TimePoint now);
  void show_elapsed(const session::Stretch* stretch, TimePoint now);

  Console* console_;
  std::optional<TimePoint> begin_;
  TimePoint next_{};
  TimePoint told_ = TimePoint::min();  ///< When something was told that is more than a wait.
  bool shown_ = false;
  bool spoke_ = false;
  int lines_ = 0;
};

}  // namespace servoctl::cli
