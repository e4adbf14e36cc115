#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

#include "base/message.hpp"
#include "base/object_address.hpp"

namespace servoctl {

/// What went wrong, in the terms a caller can act on. Each has one exit code and one name in JSON, both part
/// of the contract that scripts rely on.
enum class Errc : std::uint8_t {
  negative,     ///< It ran, and the answer is no: a difference, a failed check, an incomplete result.
  usage,        ///< The request itself is wrong; nothing was changed.
  bus,          ///< The transport is missing, down or lost.
  timeout,      ///< The node did not answer in time.
  sdo_abort,    ///< The node answered and refused.
  protocol,     ///< The node answered with something the protocol does not allow.
  file,         ///< A file cannot be read, written or parsed.
  refused,      ///< servoctl refuses for safety: a confirmation is missing, or --read-only forbids it.
  bug,          ///< A fault of servoctl itself.
  interrupted,  ///< The user pressed Ctrl-C.
};

/// Process exit code: 1 negative, 2 usage, 3 bus, 4 timeout, 5 sdo_abort, 6 protocol, 7 file, 8 refused, 70
/// bug, 130 interrupted.
int exit_code(Errc code);

/// The name in JSON: `negative usage bus no-answer sdo-abort protocol file refused bug interrupted`.
std::string_view name(Errc code);

/// A failure, told in full: what happened, to which node and object, and what to do next.
struct Error {
  Errc code = Errc::bug;
  Message message;                          ///< What happened: one sentence without a full stop.
  Message hint;                             ///< What to do next; empty when there is nothing to say.
  std::optional<std::uint8_t> node;         ///< 1..127 when one node is concerned.
  std::optional<ObjectAddress> object;      ///< Set when one object is concerned.
  std::optional<std::uint32_t> abort_code;  ///< Set only with Errc::sdo_abort (CiA 301, 7.2.4.3.17).
  std::optional<std::uint32_t> line;        ///< Line of the file the error is in, from 1.
  bool may_be_done = false;                 ///< A write that was sent: whether it was done nothing tells.
};

template <class T>
using Result = tl::expected<T, Error>;

/// An error that concerns no node, object or line.
Error make_error(Errc code, Message message, Message hint = {});

/// An error of one node: `node 3: what`; or of one of its objects: `node 3, object 0x6040:0: what`.
Error drive_error(Errc code, std::uint8_t node, const Message& what, Message hint = {});
Error drive_error(Errc code, std::uint8_t node, ObjectAddress object, const Message& what, Message hint = {});

/// What the message of an error of drive_error() says, without the node and the object.
Message what_happened(const Error& error);

/// Errc::file in a line of a file: `gain.csv:3: what`, or with the column, where that is known (from 1):
/// `gain.toml:3:7: what`.
Error file_error(std::string_view file, std::uint32_t line, const Message& what, Message hint = {});
Error file_error(std::string_view file, std::uint32_t line, std::uint32_t column, const Message& what);

/// Ends a function of Result with an error, a new one or one that is handed on: `return fail(read.error());`.
[[nodiscard]] inline tl::unexpected<Error> fail(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

[[nodiscard]] inline tl::unexpected<Error> fail(Errc code, Message message, Message hint = {}) {
  return fail(make_error(code, std::move(message), std::move(hint)));
}

}  // namespace servoctl
