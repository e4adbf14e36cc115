#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>

#include "base/time.hpp"
#include "can/frame.hpp"

namespace servoctl::sim {

/// Ways in which the way to a drive misbehaves; all off at first.
struct WireFaults {
  bool silent = false;                  ///< The cable is out: nothing is heard and nothing is said.
  std::uint32_t drop_answers = 0;       ///< So many SDO answers are lost on the way.
  std::uint32_t duplicate_answers = 0;  ///< So many SDO answers arrive twice.
  Duration answer_delay{};              ///< Every SDO answer comes this late.
  bool late = false;         ///< Every second SDO answer comes 700 ms late, and is overtaken by nothing.
  bool twice = false;        ///< Every SDO answer comes twice.
  bool wrong_index = false;  ///< Every second SDO answer names the next object index.
  bool abort_index = false;  ///< An abort names object 0000h:00h.
  bool is_short = false;     ///< SDO answers have 4 bytes.
  bool unconfirmed = false;  ///< Writes are done and not confirmed.
  bool no_stop = false;      ///< While it is energised it aborts every write of its controlword.
};

/// The words of `lie=` on CAN.
inline constexpr std::array<std::string_view, 7> kCanLies{
    "late", "twice", "wrong-index", "abort-index", "short", "unconfirmed", "no-stop"};
/// `word` is one of kCanLies.
void add_lie(WireFaults& faults, std::string_view word);

/// The way of SDO answers from a drive to the wire: with faults they are changed, late, lost or doubled. None
/// overtakes another.
class AnswerWay {
 public:
  void put(can::Frame answer, WireFaults& faults, TimePoint now);
  /// The next answer that has arrived; empty when there is none.
  std::optional<can::Frame> take(TimePoint now);
  TimePoint deadline() const { return waiting_.empty() ? kNever : waiting_.front().time; }
  void clear() { waiting_.clear(); }

 private:
  struct Waiting {
    can::Frame frame;
    TimePoint time;
  };

  std::deque<Waiting> waiting_;
  std::uint32_t number_ = 0;  ///< Of the answer.
};

}  // namespace servoctl::sim
