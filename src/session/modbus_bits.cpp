#include "session/modbus_bits.hpp"

#include "session/modbus_object_channel.hpp"

namespace servoctl::session {
namespace {

Result<std::vector<bool>> read_bits(Session& session, std::uint8_t node, modbus::Function function,
                                    std::uint16_t count) {
  const auto channel = session.modbus()->request_channel(node, session.options().timeout);
  channel->start_request(modbus::read_request(function, 0, count));
  for (;;) {
    if (const auto sent = channel->on_time(session.now()); !sent) return fail(sent.error());
    if (auto result = channel->take_result()) {
      if (!*result) return fail(result->error());
      std::vector<bool> out;
      for (unsigned i = 0; i < count; ++i) out.push_back(((**result)[2 + i / 8] >> (i % 8) & 1U) != 0);
      return out;
    }
    if (const auto stepped = session.step(channel->deadline()); !stepped) return fail(stepped.error());
  }
}

}  // namespace

Result<std::vector<bool>> read_inputs(Session& session, std::uint8_t node, std::uint16_t count) {
  return read_bits(session, node, modbus::Function::read_inputs, count);
}

Result<std::vector<bool>> read_outputs(Session& session, std::uint8_t node, std::uint16_t count) {
  return read_bits(session, node, modbus::Function::read_coils, count);
}

}  // namespace servoctl::session
