#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "base/time.hpp"
#include "can/slcan_codec.hpp"

namespace servoctl::can {

/// How an adapter is opened: C, V, Sn, then O, or L to listen only. Lines and the time go in, text to send
/// comes out; no I/O.
///
/// The adapter may be in any state: open, because its last program was killed, and full of frames; starting,
/// because its port was opened; half through a line. C is the first word, and never an empty line: some
/// firmware sends its last frame again for one. V comes before what matters because its answer is a text:
/// when it is there, every acknowledge before it is there too, however late. Firmware that acknowledges
/// nothing is known by its version, twice the same. Each round waits twice as long as the one before.
///
/// Answers come in the order of the words, so what is answered late is counted: no word is sent whose answer
/// matters while an older one may still come. What echoes is no adapter; nor is what talks without being
/// asked and acknowledges nothing.
class SlcanOpening {
 public:
  enum class Mode : std::uint8_t { normal, listen_only };
  enum class State : std::uint8_t {
    closing,          ///< C
    asking,           ///< V
    asking_again,     ///< V, where nothing was acknowledged.
    settling,         ///< Older words may still be answered.
    setting_bitrate,  ///< Sn
    opening,          ///< O or L
    open,
    no_answer,  ///< Nothing that an adapter would say.
    refused_bitrate,
    refused_opening,
    refused_listening,  ///< L: it has none, or acknowledges nothing, so that nobody knows.
  };
  static constexpr int kRounds = 3;
  /// For one answer in the first round.
  static constexpr Duration kPatience = std::chrono::milliseconds(300);
  /// All rounds, whatever the adapter does.
  static constexpr Duration kLongest = std::chrono::seconds(8);
  /// Between two commands to firmware that acknowledges nothing.
  static constexpr Duration kPause = std::chrono::milliseconds(10);

  /// `bitrate` is the digit of Sn.
  SlcanOpening(char bitrate, Mode mode, TimePoint now);

  void on_line(const SlcanLine& line, TimePoint now);
  void on_time(TimePoint now);
  /// What is to be sent now; empty when nothing is.
  std::string take_text();
  TimePoint deadline() const { return deadline_; }

  State state() const { return state_; }
  bool is_done() const { return state_ >= State::open; }
  /// Whether commands are acknowledged.
  bool acknowledges() const { return acknowledges_; }
  /// What it answered to V; empty where it did not.
  const std::string& version() const { return version_; }
  /// Something came that was neither a frame nor an answer: another device, or another baud rate.
  bool heard_something() const { return heard_something_; }

 private:
  struct Word {
    char first;
    TimePoint sent;
  };

  void enter(State state, TimePoint now);
  Duration patience() const;
  void on_answer(bool is_text, TimePoint now);
  void set_bitrate_when_settled(TimePoint now);
  void on_echo(TimePoint now);
  void on_acknowledge(TimePoint now);
  void on_refusal(TimePoint now);
  void on_text(const std::string& text, TimePoint now);
  void begin_round(TimePoint now);

  char bitrate_;
  Mode mode_;
  State state_ = State::closing;
  TimePoint deadline_ = kNever;
  std::string to_send_;
  std::string version_;
  int round_ = 0;
  std::deque<Word> unanswered_;  ///< Of all rounds, the oldest first.
  Duration latency_{};           ///< The longest that a word waited for its answer.
  TimePoint entered_{};
  bool acknowledges_ = false;
  bool heard_something_ = false;
  bool talks_ = false;   ///< Text came in this round that nothing had asked for.
  bool echoes_ = false;  ///< In this round.
};

}  // namespace servoctl::can
