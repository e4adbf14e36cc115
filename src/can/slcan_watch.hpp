#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/time.hpp"

namespace servoctl::can {

/// What an open adapter is asked regularly: its status flags (F), and its version (V) where it has none of
/// these and is silent otherwise. So it is known whether it is still there, and still open. Answers and the
/// time go in, questions come out; no I/O.
class SlcanWatch {
 public:
  enum class State : std::uint8_t {
    fine,
    silent,     ///< Nothing comes from it any more.
    restarted,  ///< It refuses the flags that it has: it is closed.
  };
  /// Between two questions for the flags (CAN232 manual: not faster than twice a second).
  static constexpr Duration kFlagsEvery = std::chrono::seconds(1);
  /// So long it may be silent that has no flags, before it is asked for its version.
  static constexpr Duration kQuiet = std::chrono::seconds(2);
  /// For an answer; a frame waits for it.
  static constexpr Duration kPatience = std::chrono::milliseconds(100);

  SlcanWatch() = default;
  /// Of one that was opened at `now`.
  SlcanWatch(bool may_have_flags, bool has_version, TimePoint now);

  /// What is to be asked now; empty when nothing is.
  std::string take_question(TimePoint now);
  TimePoint due() const { return due_; }
  /// Until when an answer is waited for; empty when none is.
  std::optional<TimePoint> awaited() const;
  /// It is waited for no more.
  void give_up() { miss(); }

  void on_bytes(TimePoint now) { heard_ = now; }
  /// False for the first flags, which are of a time before the opening.
  bool on_flags(TimePoint now);
  void on_version();
  /// An acknowledge or a refusal that no frame waits for; whether it was meant for this.
  bool on_answer(TimePoint now);

  State state() const { return state_; }
  bool has_flags() const { return has_flags_ && answered_; }

 private:
  std::string ask(char word, TimePoint now, Duration pause);
  void miss();
  bool is_silent_since(TimePoint time) const { return heard_ <= time; }

  State state_ = State::fine;
  bool has_flags_ = false;
  bool has_version_ = false;
  bool answered_ = false;  ///< Flags came.
  char asked_ = 0;         ///< `F`, `V`; 0: nothing.
  TimePoint asked_at_{};
  TimePoint first_missed_{};  ///< When the first question without an answer was asked.
  int missed_ = 0;            ///< In succession.
  int refused_ = 0;           ///< The same.
  TimePoint heard_{};
  TimePoint due_ = kNever;
};

}  // namespace servoctl::can
