#include "sim/modbus_unit.hpp"

#include <algorithm>

#include "canopen/sdo_abort.hpp"
#include "drive/naming.hpp"

namespace servoctl::sim {
namespace {

using modbus::Exception;
using modbus::Function;

/// Of one request (MODBUS Application Protocol V1.1b3, 6.3 and 6.12).
constexpr std::uint16_t kMostRead = 125;
constexpr std::uint16_t kMostWritten = 123;

/// The manuals print no exception codes: those of the standard (7), by what the drive's objects say.
Exception exception_of(std::uint32_t abort) {
  namespace codes = canopen::sdo_abort;
  switch (abort) {
    case codes::kNoObject:
    case codes::kUnsupportedAccess:
    case codes::kReadOnly:
    case codes::kWriteOnly: return Exception::illegal_address;
    case codes::kRange:
    case codes::kTooHigh:
    case codes::kTooLow: return Exception::illegal_value;
    default: return Exception::device_failure;
  }
}

Bytes refuse(ByteSpan pdu, Exception why) { return modbus::exception_answer(pdu[0], why); }

}  // namespace

ModbusUnit::ModbusUnit(const drive::Profile& profile, std::uint8_t unit, Memory& memory,
                       const std::string& key)
    : model_(profile, unit, memory, key), unit_(unit) {
  const auto place = drive::place_of(profile, profile.rules.modbus.node_id);
  const auto* entry = place ? profile.dictionary.find(*place) : nullptr;
  if (entry == nullptr || (entry->default_value && od::to_double(entry->default_value->value) == unit))
    return;
  memory.cells(key).try_emplace(*place, store_le(unit, od::size_of(entry->type).value_or(2)));
}

void ModbusUnit::power_on(TimePoint now) {
  model_.power_on(now);
  const auto kept = model_.setting(model_.profile().rules.modbus.node_id);
  if (kept && *kept > 0 && *kept < 248) unit_ = static_cast<std::uint8_t>(*kept);
}

std::optional<Bytes> ModbusUnit::on_request(ByteSpan pdu, bool to_all, TimePoint now) {
  model_.set_time(now);
  if (pdu.empty() || now >= silent_from_) return std::nullopt;
  auto out = answer(pdu);
  return to_all ? std::nullopt : std::optional(std::move(out));
}

Bytes ModbusUnit::answer(ByteSpan pdu) {
  const auto function = static_cast<Function>(pdu[0]);
  const auto& rules = model_.profile().rules.modbus;
  if (pdu.size() < 5) return refuse(pdu, Exception::illegal_function);
  switch (function) {
    case Function::read_coils: return read_bits(pdu, rules.outputs);
    case Function::read_inputs: return read_bits(pdu, rules.inputs);
    case Function::read_registers: return read_registers(pdu);
    case Function::write_register: return write_one(pdu);
    case Function::write_registers: return write_many(pdu);
  }
  return refuse(pdu, Exception::illegal_function);
}

Bytes ModbusUnit::read_bits(ByteSpan pdu, std::uint16_t there) {
  const auto first = modbus::load_be16(pdu.subspan(1));
  const auto count = modbus::load_be16(pdu.subspan(3));
  if (there == 0) return refuse(pdu, Exception::illegal_function);
  if (count == 0) return refuse(pdu, Exception::illegal_value);
  if (first + count > there) return refuse(pdu, Exception::illegal_address);
  Bytes out{pdu[0], static_cast<std::uint8_t>((count + 7) / 8)};
  out.resize(out.size() + out[1]);
  return out;
}

Bytes ModbusUnit::read_registers(ByteSpan pdu) {
  const auto first = modbus::load_be16(pdu.subspan(1));
  const auto count = modbus::load_be16(pdu.subspan(3));
  if (count == 0 || count > kMostRead) return refuse(pdu, Exception::illegal_value);
  Bytes out{pdu[0], static_cast<std::uint8_t>(count * 2)};
  for (unsigned i = 0; i < count; ++i) {
    const auto object = model_.profile().rules.modbus.object_at(static_cast<std::uint16_t>(first + i));
    Bytes bytes;
    if (!object || first + i > 0xFFFF) return refuse(pdu, Exception::illegal_address);
    if (const auto abort = model_.read(*object, bytes); abort != 0) return refuse(pdu, exception_of(abort));
    modbus::append_be16(out, static_cast<std::uint16_t>(load_le(bytes)));
  }
  return out;
}

std::uint8_t ModbusUnit::write(std::uint16_t address, std::uint16_t value) {
  const auto object = model_.profile().rules.modbus.object_at(address);
  if (!object) return static_cast<std::uint8_t>(Exception::illegal_address);
  const auto abort = model_.write(*object, store_le(value, 2));
  return abort == 0 ? 0 : static_cast<std::uint8_t>(exception_of(abort));
}

Bytes ModbusUnit::write_one(ByteSpan pdu) {
  const auto why = write(modbus::load_be16(pdu.subspan(1)), modbus::load_be16(pdu.subspan(3)));
  return why == 0 ? Bytes(pdu.begin(), pdu.begin() + 5) : refuse(pdu, static_cast<Exception>(why));
}

Bytes ModbusUnit::write_many(ByteSpan pdu) {
  const auto first = modbus::load_be16(pdu.subspan(1));
  const auto count = modbus::load_be16(pdu.subspan(3));
  if (count == 0 || count > kMostWritten || pdu.size() != 6U + count * 2U || pdu[5] != count * 2)
    return refuse(pdu, Exception::illegal_value);
  for (unsigned i = 0; i < count; ++i)
    if (const auto why =
            write(static_cast<std::uint16_t>(first + i), modbus::load_be16(pdu.subspan(6 + 2 * i)));
        why != 0)
      return refuse(pdu, static_cast<Exception>(why));
  return Bytes(pdu.begin(), pdu.begin() + 5);
}

}  // namespace servoctl::sim
