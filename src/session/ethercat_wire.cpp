#include "session/ethercat_wire.hpp"

#include <algorithm>
#include <optional>

namespace servoctl::session {

void EtherCatWire::settle(TimePoint now) {
  ring_.on_time(now);
  tenant_->serve(ring_, now);
}

Result<void> EtherCatWire::send_frames(TimePoint now) {
  while (const auto frame = ring_.take_frame(now))
    if (auto sent = port_->send(*frame); !sent) return sent;
  return {};
}

EtherCatWire::Lease::~Lease() { carrier.leave(*ring); }

Result<void> EtherCatWire::flush(TimePoint now) {
  settle(now);
  return send_frames(now);
}

TimePoint EtherCatWire::next_event() const {
  return std::min({ring_.deadline(), tenant_->deadline(), port_->next_event()});
}

Result<bool> EtherCatWire::step(TimePoint deadline) {
  // The last step served the tenant, and so does flush() for whoever begins something.
  const auto begin = now();
  if (std::min(ring_.deadline(), tenant_->deadline()) <= begin) settle(begin);
  if (const auto sent = send_frames(begin); !sent) return fail(sent.error());
  const auto frame = port_->receive(std::min({deadline, ring_.deadline(), tenant_->deadline()}));
  if (!frame) return fail(frame.error());
  stepped_at_ = *frame ? std::max(stepped_at_, port_->arrived()) : now();
  if (*frame) ring_.on_frame(**frame, stepped_at_);
  settle(stepped_at_);
  if (const auto sent = send_frames(stepped_at_); !sent) return fail(sent.error());
  return frame->has_value();
}

Result<void> EtherCatWire::go_on(TimePoint deadline) {
  if (cancelled_ && cancelled_()) return fail(Errc::interrupted, "interrupted");
  // Who cancels by the clock alone is asked so often.
  constexpr Duration kSlice = std::chrono::milliseconds(250);
  if (const auto stepped = step(std::min(deadline, now() + kSlice)); !stepped) return fail(stepped.error());
  return {};
}

Result<std::vector<EtherCatWire::Reply>> EtherCatWire::exchange(
    const std::vector<ethercat::Request>& requests) {
  std::vector<Reply> replies(requests.size());
  std::vector<std::optional<ethercat::Ring::Ticket>> tickets(requests.size());
  std::size_t posted = 0;
  std::size_t open = 0;
  Result<void> went;
  while (went && (posted < requests.size() || open > 0)) {
    for (; posted < requests.size(); ++posted) {
      tickets[posted] = ring_.post(requests[posted]);
      if (!tickets[posted]) break;  // All indices are under way.
      ++open;
    }
    went = go_on(kNever);
    for (std::size_t i = 0; i < posted; ++i) {
      const auto answer = tickets[i] ? ring_.take_answer(*tickets[i]) : std::nullopt;
      if (!answer) continue;
      replies[i] = {Bytes(answer->data.begin(), answer->data.end()), answer->working_counter, answer->lost,
                    answer->done()};
      tickets[i].reset();
      --open;
    }
  }
  if (went) return replies;
  for (const auto& ticket : tickets)
    if (ticket) ring_.forget(*ticket);
  return fail(went.error());
}

}  // namespace servoctl::session
