#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <utility>

#include "base/time.hpp"
#include "can/socketcand_codec.hpp"

namespace servoctl::can {

/// A connection to a server, from its greeting to raw mode, and whether it is still there: elements and the
/// time go in, text to send comes out; no I/O.
///
/// The server closes the connection on an element that it gets in two pieces, and takes 8 kB at a time: so no
/// more than kWindow bytes are under way that it has not read, which its answers to `< echo >` show. One that
/// does not answer that is asked no more, and TCP alone tells whether it is there.
class SocketcandDialogue {
 public:
  enum class State : std::uint8_t {
    greeted,  ///< Not yet: waits for `< hi >`.
    opening,
    entering_raw_mode,
    testing_echo,
    raw,
    refused,  ///< why() says what the server says.
    silent,   ///< It does not answer.
    stranger  ///< It is no socketcand.
  };
  /// For one answer of the server.
  static constexpr Duration kPatience = std::chrono::seconds(3);
  static constexpr Duration kEchoPatience = std::chrono::seconds(1);
  /// A server that says nothing for so long is asked whether it is there.
  static constexpr Duration kQuiet = std::chrono::seconds(1);
  static constexpr std::size_t kWindow = 2'000;

  SocketcandDialogue(std::string interface_name, TimePoint now)
      : interface_name_(std::move(interface_name)), deadline_(now + kPatience) {}

  /// All but frames, whose arrival on_life() tells.
  void on_element(const SocketcandElement& element, TimePoint now);
  /// Bytes came.
  void on_life(TimePoint now);
  void on_time(TimePoint now);
  /// What is to be sent now; empty when nothing is.
  std::string take_text() { return std::exchange(to_send_, {}); }
  TimePoint deadline() const { return deadline_; }

  State state() const { return state_; }
  bool is_settled() const { return state_ >= State::raw; }
  const std::string& why() const { return why_; }

  /// Whether `size` further bytes may be sent in raw mode.
  bool has_room(std::size_t size) const { return !echoes_ || sent_ + size - read_ <= kWindow; }
  /// So many were; every now and then an echo follows them.
  void on_sent(std::size_t size, TimePoint now);

 private:
  void enter(State state, std::string text, TimePoint now);
  void ask_for_echo(TimePoint now);
  void on_echo(TimePoint now);

  std::string interface_name_;
  State state_ = State::greeted;
  TimePoint deadline_;
  std::string to_send_;
  std::string why_;
  bool echoes_ = false;
  std::uint64_t sent_ = 0;
  std::uint64_t read_ = 0;                ///< As far as its echoes show.
  std::deque<std::uint64_t> echoes_out_;  ///< What was sent when each was asked for.
};

}  // namespace servoctl::can
