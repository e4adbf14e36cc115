#pragma once

#include <cstdint>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "base/time.hpp"

namespace servoctl::session {

class Session;

/// One transfer that was tried, and what became of it; the references live as long as the call that tells it.
struct Exchange {
  const Session& session;
  std::uint8_t node;
  ObjectAddress object;
  const Bytes* written;         ///< Null for a read.
  const Result<Bytes>& result;  ///< What was read; no bytes after a write.
  TimePoint begun;
  TimePoint ended;          ///< When its answer came, or when it was given up.
  std::uint32_t tries = 1;  ///< How often it was asked for.
};

}  // namespace servoctl::session
