#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "base/object_address.hpp"
#include "base/time.hpp"
#include "can/frame.hpp"
#include "canopen/node_watch.hpp"

namespace servoctl::canopen {

/// Notices that two nodes have the same number. Sees every frame, sent and received, and sends none.
///
/// What is a proof:
/// - an object that never changes (1000h, 1008h to 100Ah, 1018h) is answered in two ways, to one request or
/// to
///   two without a boot-up between them;
/// - three of the last eight answered requests were answered twice. One answer that comes twice is none: a
///   frame may be doubled on the bus (CAN repeats one whose last bit was disturbed);
/// - two boot-ups within half a second without an NMT reset that would explain the second.
///
/// What is not counted: answers after a request that was given up (one for each), answers to what nobody was
/// heard to ask, all of a block transfer and what comes just behind one.
class DuplicateWatch {
 public:
  /// A frame that this program sends.
  void on_sent(const can::Frame& frame, TimePoint now);
  /// A frame that is received, of another master too.
  void on_frame(const can::Frame& frame, TimePoint now);

  /// What was noticed of the node (1..127) in words, `0x1018:4 was answered by 0x00000001 and by
  /// 0x00000002`; empty: nothing.
  const std::string& noticed(std::uint8_t node) const { return nodes_[node].noticed; }
  /// An answer of the node came twice: to ask for what never changes would tell more.
  bool is_suspect(std::uint8_t node) const;
  /// Begins anew for the node (after somebody has put it right, say), as if nothing of it had been heard.
  void forget(std::uint8_t node) { nodes_[node] = {}; }
  /// The longest time from a request to its first answer so far; zero until there was one.
  Duration slowest_answer() const { return slowest_; }
  /// The longest time from a request to the second of two answers to it; zero until there was one.
  Duration slowest_second() const { return slowest_second_; }
  /// When the last answer came to a request that was open; empty until there was one.
  std::optional<TimePoint> last_answer() const { return last_answer_; }

  /// Reported once per node.
  std::optional<NodeEvent> take_event();

 private:
  struct Request {
    ObjectAddress object;
    bool segment = false;  ///< Its answer carries no object.
    TimePoint time;
  };
  struct Answered {
    ObjectAddress object;
    TimePoint asked;
    bool twice = false;
  };
  /// What an object that never changes was answered by.
  struct Constant {
    ObjectAddress object;
    std::array<std::uint8_t, 8> data{};
  };
  struct Node {
    std::vector<Request> open;
    std::vector<Answered> answered;  ///< The last ones.
    std::vector<Constant> constants;
    ObjectAddress transfer;  ///< What segments belong to.
    bool block = false;
    TimePoint block_seen = TimePoint::min();
    std::optional<TimePoint> boot;
    std::uint32_t resets = 0;  ///< Commands since the last boot-up that explain the next.
    std::string noticed;
  };

  void on_request(std::uint8_t node, const can::Frame& frame, TimePoint now);
  void on_answer(std::uint8_t id, const can::Frame& frame, TimePoint now);
  void on_surplus(std::uint8_t id, const can::Frame& frame, TimePoint now);
  void on_reset(const can::Frame& frame);
  void on_boot_up(std::uint8_t id, TimePoint now);
  void check_constant(std::uint8_t id, const can::Frame& frame, TimePoint now);
  void notice(std::uint8_t id, std::string what, TimePoint now);
  static std::vector<Request>::iterator request_of(Node& node, const can::Frame& answer);

  std::array<Node, 128> nodes_;
  Duration slowest_{};
  Duration slowest_second_{};
  std::optional<TimePoint> last_answer_;
  std::deque<NodeEvent> events_;
};

}  // namespace servoctl::canopen
