#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "session/session.hpp"

namespace servoctl::cli {

/// How often each node of some buses had been heard to start: what is at a number now may be another drive
/// than the one that was looked at before, or hold other values.
class HeardStarts {
 public:
  /// The sessions outlive it.
  explicit HeardStarts(const std::vector<session::Session*>& sessions);

  /// Takes in what has come; the first node that has started since. Of these numbers, or of all where there
  /// are none or 0 is one of them.
  std::optional<std::uint8_t> started_since(std::span<const std::uint8_t> nodes) const;

 private:
  struct Heard {
    session::Session* session;
    std::vector<std::uint32_t> starts;  ///< By node-ID.
  };
  std::vector<Heard> heard_;
};

}  // namespace servoctl::cli
