#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/bytes.hpp"

namespace servoctl::modbus {

/// Function codes (MODBUS Application Protocol V1.1b3, 6); of those servoctl sends the first four, and a
/// simulated drive understands all.
enum class Function : std::uint8_t {
  read_coils = 0x01,
  read_inputs = 0x02,
  read_registers = 0x03,
  write_register = 0x06,
  write_registers = 0x10,
};

/// What a unit answers instead (7): the function code with bit 7 set, and one of these.
enum class Exception : std::uint8_t {
  illegal_function = 0x01,
  illegal_address = 0x02,
  illegal_value = 0x03,
  device_failure = 0x04,
  acknowledge = 0x05,
  device_busy = 0x06,
  memory_parity = 0x08,
  gateway_path = 0x0A,
  gateway_target = 0x0B,
};

constexpr std::uint8_t kExceptionBit = 0x80;
/// Units have 1 to 247; 0 is a message to all that nobody answers (MODBUS over Serial Line V1.02, 2.2).
constexpr std::uint8_t kToAll = 0;
/// Of a PDU (4.1), in bytes.
constexpr std::size_t kLongestPdu = 253;

/// The name of the standard: `illegal data address`; `unknown` for any other number.
std::string_view exception_name(std::uint8_t code);
/// What it means to who asked, in a half sentence; empty where there is nothing to say.
std::string_view exception_meaning(std::uint8_t code);

/// Whether the exception leaves open what became of a request, as silence does: it is being done, the unit is
/// busy, or a gateway heard nothing of it.
bool is_open(std::uint8_t exception);

/// The PDUs of requests. Numbers have their high byte first.
Bytes read_request(Function function, std::uint16_t address, std::uint16_t count);
Bytes write_request(std::uint16_t address, std::uint16_t value);
/// The PDU of a refusal.
Bytes exception_answer(std::uint8_t function, Exception why);

/// Two bytes of a message, high byte first.
std::uint16_t load_be16(ByteSpan bytes);
void append_be16(Bytes& out, std::uint16_t value);

/// What a PDU is to a request.
enum class Fit : std::uint8_t {
  answer,     ///< Its answer.
  exception,  ///< Its refusal: the second byte says why.
  other,      ///< The answer to something else: another function, address or value.
  malformed,  ///< An answer by its function code, and of the wrong length or contents.
};
/// Both are PDUs; the request is one of read_request() or write_request().
Fit fit(ByteSpan request, ByteSpan answer);

}  // namespace servoctl::modbus
