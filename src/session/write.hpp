#pragma once

#include <span>
#include <vector>

#include "session/session.hpp"

namespace servoctl::session {

/// How a write that counts as done came to be known as done.
struct Written {
  bool answer_lost = false;        ///< The acknowledge never came; the value read back is the one written.
  std::optional<Bytes> read_back;  ///< Value read after the write, when it was read.
};

/// Writes all requests (their `data` is set) and never sends one twice. A write whose answer was lost is
/// looked up by reading the object: equal counts as written, with `answer_lost`; different or unreadable is
/// Errc::timeout, and the message says which of the two. With `read_back` every written object is read
/// afterwards; a value other than the one written is Errc::negative.
std::vector<Result<Written>> write_all(Session& session, std::span<const SdoRequest> requests,
                                       bool read_back);

}  // namespace servoctl::session
