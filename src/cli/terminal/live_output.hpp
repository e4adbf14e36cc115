#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "base/time.hpp"

namespace servoctl::cli {

/// The way to a reader who must not be waited for without end: passes text on as fast as it is taken, keeps a
/// little of it meanwhile, and leaves out what is beyond that. What was begun is never cut.
class LiveOutput {
 public:
  /// Bytes that wait for the reader; as many as a pipe holds.
  static constexpr std::size_t kMost = std::size_t{64} << 10U;

  explicit LiveOutput(int descriptor) : descriptor_(descriptor) {}
  ~LiveOutput() { close(); }
  LiveOutput(const LiveOutput&) = delete;
  LiveOutput& operator=(const LiveOutput&) = delete;

  /// Before the first offer(), and again as often as one likes.
  void open();
  void close();

  /// Waits for a reader who takes nothing at most `patience`, and not at all once that was in vain, until he
  /// takes something; a signal ends the wait. `pulse` is called in it, at once and as often as it says: it
  /// answers how long it can be left alone, zero where the wait is over. May be empty.
  void offer(std::string_view text, Duration patience = Duration::zero(),
             const std::function<Duration()>& pulse = {});
  /// Passes on what waits and the text, and waits for the reader as long as he likes; only a signal that
  /// comes meanwhile ends it, and is the error().
  void write(std::string_view text);

  /// What was offered and has not gone yet; the caller sees to it.
  std::string take_waiting() { return std::exchange(waiting_, {}); }
  /// Whether something that was offered waits for its reader.
  bool is_waiting() const { return !waiting_.empty() && error_ == 0; }
  /// That a signal ended a write() is no error for what is written from now on.
  void forget_signal();
  /// What still waits is lost, which is an error.
  void give_up();
  /// How many texts were left out since the last call.
  std::size_t take_left_out() { return std::exchange(left_out_, 0); }
  /// The first error (errno) that kept text from being written; 0 when there was none.
  int error() const { return error_; }

 private:
  std::ptrdiff_t pass(std::string_view text) const;
  void pass_on();
  int wait_for_room(Duration patience) const;
  int wait_for_room(Duration patience, const std::function<Duration()>& pulse) const;

  int descriptor_;
  int own_ = -1;  ///< The same pipe or terminal without waiting; -1 where it cannot be opened again.
  bool is_file_ = false;
  bool is_socket_ = false;
  std::string waiting_;
  std::size_t left_out_ = 0;
  bool stalled_ = false;  ///< Waited for in vain, and nothing was taken since.
  int error_ = 0;
};

}  // namespace servoctl::cli
