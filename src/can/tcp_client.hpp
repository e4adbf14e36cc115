#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "base/time.hpp"
#include "can/descriptor.hpp"

namespace servoctl::can {

/// Who is called, and what messages say of him.
struct TcpServer {
  std::string host;  ///< A name, or an address of IPv4 or IPv6.
  std::uint16_t port = 0;
  std::string name;    ///< As messages call it: `host:29536`.
  std::string absent;  ///< What to look at when nothing listens there.
  std::string closed;  ///< What to look at when it closed the connection.
};

/// A connection that does not gather bytes (TCP_NODELAY), and is given up by the kernel when the other end
/// acknowledges nothing for five seconds.
class TcpClient {
 public:
  /// Errc::bus where there is no such host, its name is not found in time, nothing listens there, or nothing
  /// answers until `limit`; Errc::interrupted by a signal where `ends_by_signal`.
  static Result<TcpClient> connect(const TcpServer& server, TimePoint limit, bool ends_by_signal);

  int get() const { return socket_.get(); }
  /// All of the text; waits for room until `limit`. Errc::bus when the connection is lost, or has no room.
  Result<void> send(std::string_view text, TimePoint limit);
  /// Closed without what was not delivered yet: the connection is lost, and it would come late.
  void abandon();
  /// Adds what is there, as take_in(). Errc::bus when the connection is lost, or was closed.
  Result<void> receive(std::string& out);

 private:
  TcpClient(Descriptor socket, TcpServer server) : socket_(std::move(socket)), server_(std::move(server)) {}
  tl::unexpected<Error> lost(int error) const;

  Descriptor socket_;
  TcpServer server_;
};

}  // namespace servoctl::can
