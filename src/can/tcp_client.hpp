#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "base/time.hpp"
#include "can/descriptor.hpp"

namespace servoctl::can {

/// A connection that does not gather bytes (TCP_NODELAY), and is given up by the kernel when the other end
/// acknowledges nothing for five seconds.
class TcpClient {
 public:
  /// `server` stands in messages. Errc::bus where there is no such host, nothing listens there, or nothing
  /// answers until `limit`; Errc::interrupted by a signal where `ends_by_signal`. The name of a host is
  /// looked up first, which takes as long as the system takes for it.
  static Result<TcpClient> connect(const std::string& host, std::uint16_t port, const std::string& server,
                                   TimePoint limit, bool ends_by_signal);

  int get() const { return socket_.get(); }
  /// All of the text; waits for room until `limit`. Errc::bus when the connection is lost, or has no room.
  Result<void> send(std::string_view text, TimePoint limit);
  /// Adds what is there. Errc::bus when the connection is lost, or was closed.
  Result<void> receive(std::string& out);

 private:
  TcpClient(Descriptor socket, std::string server) : socket_(std::move(socket)), server_(std::move(server)) {}
  tl::unexpected<Error> lost(int error) const;

  Descriptor socket_;
  std::string server_;
};

}  // namespace servoctl::can
