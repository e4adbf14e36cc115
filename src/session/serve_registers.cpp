#include "session/serve_registers.hpp"

#include <algorithm>

#include "session/open_register_line.hpp"

namespace servoctl::session {
namespace {

/// The silence that ends a message. On a real line it is shorter, and adapters are not: what they hand on in
/// bursts is one message all the same.
constexpr Duration kMessageGap = std::chrono::milliseconds(30);

}  // namespace

void RegisterEnd::send_due() {
  std::erase_if(due_, [&](const Due& due) {
    if (due.answer.time > now()) return false;
    line_->send(due.who, due.answer.bytes);
    return true;
  });
}

TimePoint RegisterEnd::next() const {
  auto out = now() + std::chrono::hours(1);
  for (const auto& due : due_) out = std::min(out, due.answer.time);
  if (line_->framing() != modbus::Framing::rtu) return out;
  for (const auto& [who, asker] : askers_)
    if (asker.in.pending()) out = std::min(out, asker.heard + kMessageGap);
  return out;
}

void RegisterEnd::take(int who, Asker& asker, sim::ModbusCell& cell) {
  while (const auto message = asker.in.take())
    if (auto answer = cell.on_message(line_->framing(), *message, now()))
      due_.push_back({who, std::move(*answer)});
}

void RegisterEnd::end_messages(sim::ModbusCell& cell) {
  for (auto& [who, asker] : askers_) {
    if (!asker.in.pending() || now() - asker.heard < kMessageGap) continue;
    asker.in.on_silence();
    take(who, asker, cell);
  }
}

Result<void> RegisterEnd::serve(sim::ModbusCell& cell) {
  for (;;) {
    cell.on_time(now());
    end_messages(cell);
    send_due();
    if (cancelled_ && cancelled_()) return {};
    auto arrival = line_->receive(std::min(next(), cell.deadline()));
    if (!arrival) return fail(arrival.error());
    const int who = arrival->who;
    if (arrival->gone) {
      askers_.erase(who);
      std::erase_if(due_, [&](const Due& due) { return due.who == who; });
      continue;
    }
    if (arrival->bytes.empty()) continue;
    auto& asker =
        askers_
            .try_emplace(who,
                         Asker{modbus::Deframer(line_->framing(), modbus::Deframer::Expects::requests), {}})
            .first->second;
    asker.heard = now();
    asker.in.push(arrival->bytes);
    take(who, asker, cell);
    // A stream that is out of step has nothing more to say.
    if (asker.in.broken()) asker.in.clear();
  }
}

Result<std::unique_ptr<RegisterEnd>> open_register_end(std::string_view url, const BusOptions& options,
                                                       std::function<bool()> cancelled) {
  auto line = open_register_listener(url, options);
  if (!line) return fail(line.error());
  return std::make_unique<RegisterEnd>(std::move(*line), std::move(cancelled));
}

}  // namespace servoctl::session
