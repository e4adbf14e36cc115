#include "session/drive_error.hpp"

#include <fmt/format.h>
#include <utility>

namespace servoctl::session {

Error drive_error(Errc code, std::uint8_t node, const std::string& what, std::string hint) {
  Error error;
  error.code = code;
  error.message = fmt::format("node {}: {}", node, what);
  error.hint = std::move(hint);
  error.node = node;
  return error;
}

}  // namespace servoctl::session
