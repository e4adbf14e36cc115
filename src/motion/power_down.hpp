#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drive/cia402.hpp"
#include "motion/dialogue.hpp"
#include "session/rehearsal.hpp"

namespace servoctl::motion {

/// Controlwords of a way down (CiA 402-2, 8.4.1).
inline constexpr std::uint16_t kHalted = 0x010F;
inline constexpr std::uint16_t kQuickStopWord = 0x0002;
inline constexpr std::uint16_t kSwitchOffWord = 0x0007;
inline constexpr std::uint16_t kDisableVoltageWord = 0x0000;

/// What a way down is to reach.
enum class PowerAim : std::uint8_t {
  stop,              ///< 02h, and wait until it has no power or stands still.
  disable,           ///< 07h, which lets the drive ramp down and set its brake, then 00h.
  stop_and_disable,  ///< 02h, then 07h where it is still enabled, then 00h.
};

/// How a motion is ended before a quick stop is needed.
struct GentleStop {
  bool halt = false;  ///< By bit 8 of 6040h.
  /// Sets the target of the mode to zero, where that stops the motor: written before anything is read.
  std::optional<session::SdoRequest> zero_target;
};

/// How one drive is taken down.
struct PowerDownPlan {
  std::uint8_t node = 0;
  PowerAim aim = PowerAim::disable;
  std::optional<GentleStop> gentle = {};  ///< Where the motion is known.
  /// Size of the speed in an answer of 606Ch, in the unit of `standstill`; empty when it says none. Without
  /// this, standstill is judged by the greatest speed seen.
  std::function<std::optional<double>(ByteSpan)> speed = {};
  double standstill = 0;
  /// Gives the words for what is sent beside controlwords; set by take_down().
  const session::Network* network = nullptr;
  bool keeps_exchange = false;  ///< Process data go on behind it; else they end with its power.
  /// Called once, when the drive does not answer. Not on a ring: there it would end the cycles that carry
  /// the stop words.
  std::function<void()> on_silence = {};
  /// Nothing tells that there is a drive of this number: without an answer it is woken at once, and asked
  /// once more.
  bool may_be_absent = false;
};

/// What was seen of it.
struct PowerDownResult {
  Result<void>
      outcome;  ///< Errc::negative when it does not follow; of its last answer when it does not tell.
  /// The first that was seen behind the first command, where that was answered.
  std::optional<drive::DriveState> found;
  std::optional<std::uint16_t> statusword;  ///< The last that was read, if it was after the last command.
  bool stopped = false;     ///< It was seen at rest, or without power, before its power was taken away.
  bool quick_stop = false;  ///< It was sent 02h.
  bool written = false;     ///< The last command was acknowledged: 02h, or 00h.
  int ignored = 0;      ///< So many times 00h was acknowledged, and the drive kept its power for a second.
  bool silent = false;  ///< It did not answer in the end.
  std::vector<std::string> notes;  ///< By which other means it was tried.

  drive::DriveState state() const;
  /// Whether it had power before it was commanded, as far as its first state tells: 02h may take the power of
  /// a motor at rest at once, and 07h takes "ready to switch on" to "switched on".
  std::optional<bool> had_power() const;
  /// A state in which nothing is commanded on: without power, and not on the way up.
  bool is_without_power() const;
};

/// A state in which a drive has no power and is not on its way up.
bool is_without_power(drive::DriveState state);

/// The way down of one drive; how it goes on when a drive refuses, ignores or does not answer: the next means
/// is tried, in the end a request of another state. 00h is written whatever the statusword says, because a
/// drive that has lost its power by itself may start again with what 6040h holds; 6040h is read back for the
/// same reason.
class PowerDown final : public Dialogue {
 public:
  /// Longest wait for one transition; manuals name none, and a brake takes some tenths of a second.
  static constexpr Duration kPatience = std::chrono::seconds(1);
  /// Longest wait for the end of a quick stop; its ramp (6085h) is the machine's.
  static constexpr Duration kQuickStopPatience = std::chrono::seconds(3);
  /// Time for the ramp of a quick stop when nothing can be read; then 07h and 00h are sent.
  static constexpr Duration kBlindStop = std::chrono::milliseconds(200);
  /// Longest way down, whatever comes back: each step has a limit, but a drive can make many of them.
  static constexpr Duration kLongest = std::chrono::seconds(15);

  explicit PowerDown(PowerDownPlan plan);

  std::uint8_t node() const override { return plan_.node; }
  DialogueStep next(TimePoint now) override;
  void on_answer(Result<Bytes> answer, TimePoint now) override;
  void on_bus_back() override;
  void hasten(TimePoint now) override;
  std::optional<session::SdoRequest> last_word() const override;
  void on_end(const Error& error) override;

  const PowerDownResult& result() const { return result_; }
  const PowerDownPlan& plan() const { return plan_; }

 private:
  enum class State : std::uint8_t {
    zero_target,
    look,
    halt,
    slowing,
    slowing_speed,
    quick_stop,
    stopping,
    stopping_speed,
    switch_off,
    switching_off,
    cut,
    cutting,
    holding,
    wake,
    last_state,
    wake_again,
    done
  };

  void begin();
  void enter(State state, TimePoint now);
  void poll_again(State state, TimePoint now);
  void on_silence(const Error& error, TimePoint now);
  void wake_or_cut(bool cutting, TimePoint now);
  void go_on_blindly(TimePoint now);
  void end_silent(const Error& error);
  bool is_on_ring() const;
  drive::DriveState take_state(const Result<Bytes>& answer);
  void on_look(const Result<Bytes>& answer, TimePoint now);
  void on_slowing(const Result<Bytes>& answer, TimePoint now);
  void on_slowing_speed(const Result<Bytes>& answer, TimePoint now);
  void on_quick_stop(const Result<Bytes>& answer, TimePoint now);
  void on_stopping(const Result<Bytes>& answer, TimePoint now);
  void on_stopping_speed(const Result<Bytes>& answer, TimePoint now);
  void after_stop(TimePoint now);
  void on_switch_off(const Result<Bytes>& answer, TimePoint now);
  void on_switching_off(const Result<Bytes>& answer, TimePoint now);
  void on_cut(const Result<Bytes>& answer, TimePoint now);
  void on_cutting(const Result<Bytes>& answer, TimePoint now);
  void on_holding(const Result<Bytes>& answer, TimePoint now);
  void cut_again(TimePoint now);
  void end_stop();
  void end_cut();
  void finish(Result<void> outcome);
  session::SdoRequest command(std::uint16_t controlword) const;
  session::SdoRequest read(ObjectAddress object) const;
  std::string word() const;
  session::NodeState last_state() const;
  std::string order(session::NodeState state) const;
  std::optional<double> speed_in(const Result<Bytes>& answer);

  PowerDownPlan plan_;
  PowerDownResult result_;
  State state_ = State::done;
  State back_to_ = State::done;          ///< After a node was woken up by NMT.
  TimePoint since_{};                    ///< When this state was entered.
  std::optional<TimePoint> begun_;       ///< When the first word was asked for.
  std::optional<TimePoint> stop_since_;  ///< When 02h was sent for the first time.
  TimePoint pause_ = TimePoint::min();
  drive::DriveState seen_ = drive::DriveState::unknown;
  bool has_seen_ = false;
  bool gently_ = false;  ///< Something was written that ends the motion.
  bool woken_ = false;
  bool stopped_again_ = false;  ///< 02h was repeated, because nothing could be read.
  bool told_silence_ = false;
  int tries_ = 0;
  int silences_ = 0;  ///< Answers that did not come since something was read last.
  int means_ = 0;     ///< How many other means were tried.
  std::optional<double> first_speed_;
  std::optional<double> fastest_;
  std::optional<TimePoint> standing_since_;
  int held_ = 0;                 ///< How often 6040h was seen to keep what enables.
  std::string untaken_;          ///< Why the last command is not in 6040h.
  std::optional<Error> unread_;  ///< Why the statusword was not read last.
};

/// What is written to a drive that follows and of which nothing more is known, in order; NMT where it does
/// not.
std::vector<session::PlannedMessage> planned_power_down(std::uint8_t node, PowerAim aim);

/// Takes all these drives down at the same time: the first word goes to all of them before any answer is
/// waited for, and a drive that is slow or dead delays none. A bus that is lost meanwhile is waited for
/// (LinkWait). Does not hear Ctrl-C. The results in the order of the plans, whose nodes are different ones.
std::vector<PowerDownResult> take_down(session::Session& session, std::vector<PowerDownPlan> plans);

}  // namespace servoctl::motion
