#include "base/result.hpp"

#include "base/format.hpp"

namespace servoctl {

int exit_code(Errc code) {
  switch (code) {
    case Errc::negative: return 1;
    case Errc::usage: return 2;
    case Errc::bus: return 3;
    case Errc::timeout: return 4;
    case Errc::sdo_abort: return 5;
    case Errc::protocol: return 6;
    case Errc::file: return 7;
    case Errc::refused: return 8;
    case Errc::bug: return 70;
    case Errc::interrupted: return 130;
  }
  return 70;
}

std::string_view name(Errc code) {
  switch (code) {
    case Errc::negative: return "negative";
    case Errc::usage: return "usage";
    case Errc::bus: return "bus";
    case Errc::timeout: return "no-answer";
    case Errc::sdo_abort: return "sdo-abort";
    case Errc::protocol: return "protocol";
    case Errc::file: return "file";
    case Errc::refused: return "refused";
    case Errc::bug: return "bug";
    case Errc::interrupted: return "interrupted";
  }
  return "bug";
}

Error make_error(Errc code, std::string message, std::string hint) {
  Error error;
  error.code = code;
  error.message = std::move(message);
  error.hint = std::move(hint);
  return error;
}

Error drive_error(Errc code, std::uint8_t node, std::string_view what, std::string hint) {
  auto error = make_error(code, formatted("node {}: {}", node, what), std::move(hint));
  error.node = node;
  return error;
}

Error drive_error(Errc code, std::uint8_t node, ObjectAddress object, std::string_view what,
                  std::string hint) {
  auto error =
      make_error(code, formatted("node {}, object {}: {}", node, to_string(object), what), std::move(hint));
  error.node = node;
  error.object = object;
  return error;
}

Error file_error(std::string_view file, std::uint32_t line, std::string_view what, std::string hint) {
  auto error = make_error(Errc::file, formatted("{}:{}: {}", file, line, what), std::move(hint));
  error.line = line;
  return error;
}

Error file_error(std::string_view file, std::uint32_t line, std::uint32_t column, std::string_view what) {
  auto error = make_error(Errc::file, formatted("{}:{}:{}: {}", file, line, column, what));
  error.line = line;
  return error;
}

}  // namespace servoctl
