#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "session/hearing.hpp"
#include "session/session.hpp"

namespace servoctl::cli {

/// What drives were last heard to say of their state: the statusword wherever it is answered to an SDO read,
/// of another master too, emergencies, and what the network knows of its nodes. Sends nothing, ever.
class HeardStates {
 public:
  /// What was heard longer ago than this may no longer be so.
  static constexpr Duration kFresh = std::chrono::seconds(5);

  /// Lives no longer than the session.
  explicit HeardStates(session::Session& session);

  struct State {
    std::string text;    ///< `operation enabled`, `EMCY 0x2310`, `pre-operational`; empty: nothing is known.
    bool old = false;    ///< Heard longer ago than kFresh.
    bool fault = false;  ///< A fault, or an emergency after what was last heard of the state.
    bool operator==(const State&) const = default;
  };
  State state(std::uint8_t node) const;

 private:
  struct Word {
    std::uint16_t value = 0;
    TimePoint time;
  };
  struct Node {
    std::optional<Word> status;     ///< 6041h.
    std::optional<Word> emergency;  ///< Its code; none after an error reset.
    std::uint32_t boots = 0;        ///< When it was heard.
  };
  void on_frame(const can::Frame& frame, TimePoint time);
  void on_answer(std::uint8_t node, const can::Frame& frame, TimePoint time);
  Node& of_now(std::uint8_t node);

  session::Session* session_;
  std::array<Node, 128> nodes_{};
  session::Hearing hearing_;
};

}  // namespace servoctl::cli
