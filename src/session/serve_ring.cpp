#include "session/serve_ring.hpp"

#include <algorithm>
#include <utility>

#include "ethernet/frame_limits.hpp"
#include "session/open_port.hpp"

namespace servoctl::session {

/// What nobody is there to take is lost. Masters leave it to the interface to fill short frames up, and a
/// virtual one does not.
Result<void> RingEnd::send_back(sim::EscRing& ring) {
  while (auto frame = ring.take_frame()) {
    frame->resize(std::max(frame->size(), ethernet::kShortestFrame));
    if (auto sent = port_->send(*frame); !sent && port_->has_link()) return sent;
  }
  return {};
}

Result<void> RingEnd::serve(sim::EscCell& cell) {
  for (;;) {
    cell.ring.on_time(now());
    if (auto sent = send_back(cell.ring); !sent) return sent;
    if (cancelled_ && cancelled_()) return {};
    const auto frame = port_->receive(std::min(cell.ring.deadline(), now() + std::chrono::hours(1)));
    if (!frame) return fail(frame.error());
    if (*frame) cell.ring.on_frame(**frame, now());
  }
}

Result<std::unique_ptr<RingEnd>> open_ring_end(std::string_view url, const BusOptions& options,
                                               std::function<bool()> cancelled) {
  auto port = open_ring_port(url, options);
  if (!port) return fail(port.error());
  return std::make_unique<RingEnd>(std::move(*port), std::move(cancelled));
}

}  // namespace servoctl::session
