#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "ethernet/port.hpp"
#include "sim/esc_cell.hpp"
#include "sim/sim_clock.hpp"

namespace servoctl::sim {

/// An Ethernet wire inside this process, with a ring of simulated drives on it. With virtual time every wait
/// ends at once and costs no real time; a frame takes 40 us.
class SimPort final : public ethernet::Port {
 public:
  SimPort(EscCell cell, SimClock clock) : cell_(std::move(cell)), clock_(clock) {}

  TimePoint now() const override { return clock_.now(); }
  /// Errc::bug for a frame that is too short or too long.
  Result<void> send(ByteSpan frame) override;
  Result<std::optional<ByteSpan>> receive(TimePoint deadline) override;
  TimePoint next_event() const override;
  Result<void> recover(TimePoint) override { return {}; }
  bool has_link() const override { return cell_.ring.reachable() > 0; }

  /// What is on the wire, for tests that look past it.
  EscCell& cell() { return cell_; }

 private:
  bool take();

  EscCell cell_;
  SimClock clock_;
  std::optional<Bytes> received_;  ///< Not given yet.
  Bytes given_;
};

/// A wire in this process with the drives of build_esc_cell(); errors as there.
Result<std::unique_ptr<ethernet::Port>> open_sim_port(std::string_view text,
                                                      std::span<const std::filesystem::path> folders,
                                                      SimClock::Kind clock);

}  // namespace servoctl::sim
