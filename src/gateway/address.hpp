#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace servoctl::gateway {

/// Where a gateway of CiA 309-3 is: a TCP port, or a socket of this machine.
struct Address {
  std::string host;  ///< Empty where it is a path.
  std::uint16_t port = 60'000;
  std::string path;
  std::uint16_t network = 1;  ///< On the other side, for who asks.

  bool is_path() const { return !path.empty(); }
  /// Only processes of this machine reach it.
  bool is_local() const;
  std::string text() const;  ///< `host:60000`, `[::1]:60000`, `/run/gateway`.
};

/// Where to listen: `127.0.0.1:60000`, `[::1]:60000`, `127.0.0.1`, `/run/gateway`. Errc::usage.
Result<Address> parse_place(std::string_view text);
/// What stands behind `gateway:` in the URL of a bus: `//host:60000`, `//host/2` with the number of the
/// network there, `/run/gateway`. Errc::usage.
Result<Address> parse_url(std::string_view text);

}  // namespace servoctl::gateway
