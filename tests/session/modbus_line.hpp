#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "modbus/port.hpp"

namespace servoctl::session {

/// What a line of the test does: it notes what is sent, and what comes back is said by the test. Time is its
/// own.
struct ModbusScript {
  TimePoint now{std::chrono::seconds(1)};
  modbus::Framing framing = modbus::Framing::rtu;
  std::vector<std::string> sent;  ///< In hexadecimal.
  std::vector<TimePoint> times;   ///< When.
  /// The answer to a request: bytes, and how long after it; empty for silence.
  std::function<std::vector<std::pair<Duration, Bytes>>(const Bytes&)> answer;
  std::deque<std::pair<TimePoint, Bytes>> coming;
  bool lost = false;
  unsigned reopened = 0;
};

class ScriptedLine final : public modbus::Port {
 public:
  explicit ScriptedLine(ModbusScript& script) : script_(&script) {}

  modbus::Framing framing() const override { return script_->framing; }
  Duration silence() const override { return Duration(1750); }
  TimePoint now() const override { return script_->now; }
  Result<void> send(ByteSpan bytes) override {
    if (script_->lost) return fail(Errc::bus, "the line is gone");
    script_->sent.push_back(to_hex(bytes));
    script_->times.push_back(script_->now);
    if (!script_->answer) return {};
    for (auto& [after, what] : script_->answer(Bytes(bytes.begin(), bytes.end())))
      script_->coming.emplace_back(script_->now + after, std::move(what));
    return {};
  }
  Result<Bytes> receive(TimePoint deadline) override {
    if (script_->lost) return fail(Errc::bus, "the line is gone");
    auto& coming = script_->coming;
    if (coming.empty() || coming.front().first > deadline) {
      if (deadline != kNever) script_->now = std::max(script_->now, deadline);
      return Bytes();
    }
    auto [time, out] = std::move(coming.front());
    coming.pop_front();
    script_->now = std::max(script_->now, time);
    return std::move(out);
  }
  Result<void> reopen(TimePoint) override {
    ++script_->reopened;
    script_->lost = false;
    return {};
  }

 private:
  ModbusScript* script_;
};

}  // namespace servoctl::session
