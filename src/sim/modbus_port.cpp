#include "sim/modbus_port.hpp"

#include <algorithm>

namespace servoctl::sim {

Result<void> ModbusSimPort::send(ByteSpan bytes) {
  // With start and stop bit a character has ten bits.
  constexpr std::int64_t kCharacterNs = 10 * 1'000'000'000LL / 115'200;
  clock_.move_on(Duration(static_cast<Duration::rep>(bytes.size()) * kCharacterNs / 1000));
  in_.push(bytes);
  while (const auto message = in_.take())
    if (auto answer = cell_.on_message(modbus::Framing::rtu, *message, now()))
      answers_.push_back(std::move(*answer));
  in_.on_silence();
  return {};
}

Result<Bytes> ModbusSimPort::receive(TimePoint deadline) {
  for (;;) {
    cell_.on_time(now());
    if (next_event() <= now()) {
      auto out = std::move(answers_.front().bytes);
      answers_.pop_front();
      return out;
    }
    const auto wake = std::min({next_event(), cell_.deadline(), deadline});
    if (!clock_.wait_until(wake)) return Bytes();
    if (wake == deadline && next_event() > deadline) return Bytes();
  }
}

Result<std::unique_ptr<modbus::Port>> open_modbus_sim(std::string_view text,
                                                      std::span<const std::filesystem::path> folders,
                                                      SimClock::Kind clock) {
  const SimClock own(clock);
  auto cell = build_modbus_cell(text, folders, own.now());
  if (!cell) return fail(cell.error());
  return std::make_unique<ModbusSimPort>(std::move(*cell), own);
}

}  // namespace servoctl::sim
