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

/// What is known of the object behind a write.
enum class WriteEnd : std::uint8_t {
  written,
  not_written,  ///< Refused, or never asked for.
  other_value,  ///< Read back: the drive holds something else.
  unknown,      ///< No answer, and it cannot be read; or the bus was lost or Ctrl-C came meanwhile.
};
/// `object`: that of the write, because the error of one that was skipped names another one.
WriteEnd write_end(const Result<Written>& written, ObjectAddress object);
/// For the column `state`: `written, read back`, `not known`.
std::string_view state_text(const Result<Written>& written, ObjectAddress object);

/// Writes all requests (their `data` is set) and never sends one twice. A write whose answer was lost is
/// looked up by reading the object: equal counts as written, with `answer_lost`; different is Errc::negative,
/// unreadable Errc::timeout or Errc::protocol. With `read_back` every written object is read
/// afterwards; a value other than the one written is Errc::negative.
std::vector<Result<Written>> write_all(Session& session, std::span<const SdoRequest> requests,
                                       bool read_back);

}  // namespace servoctl::session
