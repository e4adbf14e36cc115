#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "can/bus.hpp"
#include "can/foreign_clock.hpp"
#include "can/socketcand_codec.hpp"
#include "can/socketcand_dialogue.hpp"
#include "can/tcp_client.hpp"

namespace servoctl::can {

/// Joins a CAN interface of another machine by its socketcand: `//host:29536/can0`, see
/// parse_socketcand_place(). Errors as there, and of TcpClient::connect(); Errc::bus where the server refuses
/// the interface, does not answer, or is none. Whoever can reach the server can do the same: the protocol has
/// neither login nor encryption.
Result<std::unique_ptr<Bus>> open_socketcand(std::string_view place);

/// A bus behind such a server. A frame counts as sent when the connection has taken it.
class SocketcandBus final : public Bus {
 public:
  explicit SocketcandBus(SocketcandPlace place) : place_(std::move(place)) {}

  /// As open_socketcand(); takes three seconds at most for the connection, and for each answer. `limit` ends
  /// it early. A signal ends it only where `ends_by_signal`.
  Result<void> open(TimePoint limit, bool ends_by_signal);

  TimePoint now() const override { return steady_now(); }
  /// Errc::bug for a frame that is not one of ISO 11898-1; Errc::usage for a remote frame, which the protocol
  /// does not have.
  Result<void> send(const Frame& frame) override;
  Result<std::optional<Frame>> receive(TimePoint deadline) override;
  /// The connection has half a second at least; a dialogue that has not ended by then goes on with the next
  /// call.
  Result<void> recover(TimePoint deadline) override;
  TimePoint arrived() const override { return arrived_; }
  int poll_fd() const override { return is_open() ? connection_->get() : -1; }
  std::vector<Message> take_notices() override;
  TimePoint next_event() const override;

 private:
  struct Received {
    Frame frame;
    TimePoint time;
  };

  bool is_open() const { return connection_ && !opening_; }
  Result<void> begin(TimePoint limit, bool ends_by_signal);
  Result<void> settle(TimePoint limit, bool ends_by_signal);
  Result<void> judge() const;
  Result<void> fill();
  void on_element(const SocketcandElement& element, TimePoint time);
  /// Sends what the dialogue wants sent.
  Result<void> speak();
  Result<void> await_room(std::size_t size, TimePoint limit);
  tl::unexpected<Error> lose(Error error);
  tl::unexpected<Error> not_there() const;

  SocketcandPlace place_;
  std::optional<TcpClient> connection_;
  std::optional<SocketcandDialogue> dialogue_;
  bool opening_ = false;       ///< The interface is not open yet.
  std::optional<Error> lost_;  ///< Why there is no connection any more.
  SocketcandReader reader_;
  ForeignClock stamps_;
  std::size_t damaged_ = 0;              ///< Elements since they were last told.
  std::vector<std::string> complaints_;  ///< Of the server, since they were last told.
  std::deque<Received> inbox_;
  TimePoint arrived_{};
};

}  // namespace servoctl::can
