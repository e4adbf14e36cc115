#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/result.hpp"
#include "base/time.hpp"
#include "can/descriptor.hpp"
#include "can/tcp_client.hpp"
#include "gateway/address.hpp"

namespace servoctl::gateway {

/// A connection to a gateway, by TCP or a socket of this machine.
class Connection {
 public:
  /// Errc::bus where nothing listens there or nothing answers until `limit`; Errc::interrupted by a signal
  /// where `ends_by_signal`.
  static Result<Connection> open(const Address& address, TimePoint limit, bool ends_by_signal);

  int get() const { return tcp_ ? tcp_->get() : local_.get(); }
  /// All of the text; waits for room until `limit`. Errc::bus when the connection is lost.
  Result<void> send(std::string_view text, TimePoint limit);
  /// Adds what is there, as take_in(). Errc::bus when the connection is lost, or was closed.
  Result<void> receive(std::string& out);
  /// What goes without waiting, for the very end.
  void send_now(std::string_view text) const noexcept;

 private:
  explicit Connection(std::string place) : place_(std::move(place)) {}
  static Result<Connection> open_path(const Address& address);

  std::string place_;
  std::optional<can::TcpClient> tcp_;
  can::Descriptor local_;
};

}  // namespace servoctl::gateway
