#pragma once

#include <functional>
#include <memory>
#include <string_view>
#include <utility>

#include "base/result.hpp"
#include "base/time.hpp"
#include "ethernet/port.hpp"
#include "session/open_bus.hpp"
#include "sim/esc_cell.hpp"

namespace servoctl::session {

/// The slaves' end of a wire with EtherCAT.
class RingEnd {
 public:
  RingEnd(std::unique_ptr<ethernet::Port> port, std::function<bool()> cancelled)
      : port_(std::move(port)), cancelled_(std::move(cancelled)) {}

  TimePoint now() const { return port_->now(); }
  /// Lets simulated drives live on the wire until it is cancelled. Errc::bus when the wire is lost; a
  /// master that goes, or a cable that is unplugged, is none.
  Result<void> serve(sim::EscCell& cell);
  /// The last call: as ethernet::Port::end_trace().
  void close() { port_->end_trace(); }

 private:
  Result<void> send_back(sim::EscRing& ring);

  std::unique_ptr<ethernet::Port> port_;
  std::function<bool()> cancelled_;
};

/// `cancelled` is asked in every wait. Errors as open_ring_port().
Result<std::unique_ptr<RingEnd>> open_ring_end(std::string_view url, const BusOptions& options,
                                               std::function<bool()> cancelled);

}  // namespace servoctl::session
