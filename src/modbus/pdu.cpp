#include "modbus/pdu.hpp"

#include <algorithm>

namespace servoctl::modbus {

std::string_view exception_name(std::uint8_t code) {
  switch (static_cast<Exception>(code)) {
    case Exception::illegal_function: return "illegal function";
    case Exception::illegal_address: return "illegal data address";
    case Exception::illegal_value: return "illegal data value";
    case Exception::device_failure: return "server device failure";
    case Exception::acknowledge: return "acknowledge";
    case Exception::device_busy: return "server device busy";
    case Exception::memory_parity: return "memory parity error";
    case Exception::gateway_path: return "gateway path unavailable";
    case Exception::gateway_target: return "gateway target device failed to respond";
  }
  return "unknown";
}

std::string_view exception_meaning(std::uint8_t code) {
  switch (static_cast<Exception>(code)) {
    case Exception::illegal_function: return "the device does not know this function";
    case Exception::illegal_address: return "it has no such register, or it cannot be written";
    case Exception::illegal_value: return "the register does not take this value";
    case Exception::device_failure: return "it could not do what was asked";
    case Exception::acknowledge: return "it has begun, and is not done yet";
    case Exception::device_busy: return "it is busy: try again later";
    case Exception::memory_parity: return "its memory is damaged";
    case Exception::gateway_path: return "the gateway has no line to this unit";
    case Exception::gateway_target: return "behind the gateway nobody answers at this address";
  }
  return {};
}

bool is_open(std::uint8_t exception) {
  switch (static_cast<Exception>(exception)) {
    case Exception::acknowledge:
    case Exception::device_busy:
    case Exception::gateway_path:
    case Exception::gateway_target: return true;
    default: return false;
  }
}

std::uint16_t load_be16(ByteSpan bytes) {
  return static_cast<std::uint16_t>((unsigned{bytes[0]} << 8U) | bytes[1]);
}

void append_be16(Bytes& out, std::uint16_t value) {
  out.push_back(static_cast<std::uint8_t>(value >> 8U));
  out.push_back(static_cast<std::uint8_t>(value & 0xFFU));
}

namespace {

Bytes request(Function function, std::uint16_t first, std::uint16_t second) {
  Bytes out{static_cast<std::uint8_t>(function)};
  append_be16(out, first);
  append_be16(out, second);
  return out;
}

}  // namespace

Bytes read_request(Function function, std::uint16_t address, std::uint16_t count) {
  return request(function, address, count);
}

Bytes write_request(std::uint16_t address, std::uint16_t value) {
  return request(Function::write_register, address, value);
}

Bytes exception_answer(std::uint8_t function, Exception why) {
  return {static_cast<std::uint8_t>(function | kExceptionBit), static_cast<std::uint8_t>(why)};
}

Fit fit(ByteSpan request, ByteSpan answer) {
  if (request.size() != 5 || answer.empty()) return Fit::malformed;
  const auto function = request[0];
  if (answer[0] == (function | kExceptionBit)) return answer.size() == 2 ? Fit::exception : Fit::malformed;
  if (answer[0] != function) return Fit::other;
  if (function == static_cast<std::uint8_t>(Function::write_register)) {
    if (answer.size() != request.size()) return Fit::malformed;
    return std::equal(request.begin(), request.end(), answer.begin()) ? Fit::answer : Fit::other;
  }
  const auto count = load_be16(request.subspan(3));
  const bool registers = function == static_cast<std::uint8_t>(Function::read_registers);
  const auto bytes = registers ? std::size_t{count} * 2 : (std::size_t{count} + 7) / 8;
  return answer.size() == bytes + 2 && answer[1] == bytes ? Fit::answer : Fit::malformed;
}

}  // namespace servoctl::modbus
