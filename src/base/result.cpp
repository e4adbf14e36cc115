#include "base/result.hpp"

#include <string>

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

namespace {

constexpr const char* kOfNode = "node {}: {}";
constexpr const char* kOfObject = "node {}, object {}: {}";

}  // namespace

Error make_error(Errc code, Message message, Message hint) {
  Error error;
  error.code = code;
  error.message = std::move(message);
  error.hint = std::move(hint);
  return error;
}

Error drive_error(Errc code, std::uint8_t node, const Message& what, Message hint) {
  auto error = make_error(code, Message(kOfNode, {node_name(node), Boxed<Message>(what)}), std::move(hint));
  error.node = node;
  return error;
}

Error drive_error(Errc code, std::uint8_t node, ObjectAddress object, const Message& what, Message hint) {
  auto error = make_error(
      code, Message(kOfObject, {node_name(node), Verbatim{to_string(object)}, Boxed<Message>(what)}),
      std::move(hint));
  error.node = node;
  error.object = object;
  return error;
}

Message what_happened(const Error& error) {
  const auto& message = error.message;
  if (message.literal() != kOfNode && message.literal() != kOfObject) return message;
  const auto* what = std::get_if<Boxed<Message>>(&message.arguments().back());
  return what == nullptr ? message : *what->get();
}

Error file_error(std::string_view file, std::uint32_t line, const Message& what, Message hint) {
  auto error =
      make_error(Errc::file, message("{}:{}: {}", Verbatim{std::string(file)}, line, what), std::move(hint));
  error.line = line;
  return error;
}

Error file_error(std::string_view file, std::uint32_t line, std::uint32_t column, const Message& what) {
  auto error =
      make_error(Errc::file, message("{}:{}:{}: {}", Verbatim{std::string(file)}, line, column, what));
  error.line = line;
  return error;
}

}  // namespace servoctl
