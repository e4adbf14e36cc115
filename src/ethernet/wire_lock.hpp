#pragma once

#include <string>
#include <utility>

#include "base/result.hpp"
#include "can/descriptor.hpp"

namespace servoctl::ethernet {

/// Held by the one process that uses a wire. The system gives it back however the process ends, and leaves
/// nothing behind. It binds the processes of all users, in one network namespace: interfaces are of one as
/// well.
class WireLock {
 public:
  /// `key` tells wires apart, `shown` is what people call this one. Errc::bus when another process holds it,
  /// with words that say which.
  static Result<WireLock> take(const std::string& key, const std::string& shown);

 private:
  explicit WireLock(can::Descriptor socket) : socket_(std::move(socket)) {}

  can::Descriptor socket_;  ///< Bound to a name of which there is one.
};

}  // namespace servoctl::ethernet
