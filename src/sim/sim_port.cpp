#include "sim/sim_port.hpp"

#include <algorithm>
#include <utility>

#include "ethernet/frame_limits.hpp"

namespace servoctl::sim {
namespace {

/// So long is a frame of common size on its way through a few slaves and back.
constexpr Duration kRingFrameTime{40};

}  // namespace

Result<void> SimPort::send(ByteSpan frame) {
  if (const auto checked = ethernet::check_frame(frame); !checked) return checked;
  cell_.ring.on_frame(frame, now());
  return {};
}

/// Whether a frame has come back.
bool SimPort::take() {
  cell_.ring.on_time(now());
  if (!received_) received_ = cell_.ring.take_frame();
  return received_.has_value();
}

TimePoint SimPort::next_event() const { return received_ ? now() : cell_.ring.deadline(); }

Result<std::optional<ByteSpan>> SimPort::receive(TimePoint deadline) {
  for (;;) {
    if (take()) {
      clock_.move_on(kRingFrameTime);
      given_ = std::move(*received_);
      received_.reset();
      return std::optional<ByteSpan>(given_);
    }
    const auto wake = std::min(next_event(), deadline);
    if (!clock_.wait_until(wake)) return std::optional<ByteSpan>();
    if (wake == deadline && next_event() > deadline) return std::optional<ByteSpan>();
  }
}

Result<std::unique_ptr<ethernet::Port>> open_sim_port(std::string_view text,
                                                      std::span<const std::filesystem::path> folders,
                                                      SimClock::Kind clock) {
  const SimClock own(clock);
  auto cell = build_esc_cell(text, folders, own.now());
  if (!cell) return fail(cell.error());
  return std::make_unique<SimPort>(std::move(*cell), own);
}

}  // namespace servoctl::sim
