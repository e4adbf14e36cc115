#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "can/descriptor.hpp"
#include "ethernet/end.hpp"
#include "ethernet/frame_limits.hpp"
#include "ethernet/port.hpp"
#include "ethernet/wire_lock.hpp"

namespace servoctl::ethernet {

/// How long an interface that was just brought up is waited for to have a link.
inline constexpr Duration kLinkPatience = std::chrono::seconds(3);

/// Opens an Ethernet interface of the kernel, such as `eth0`, for EtherCAT frames alone, and for this process
/// alone. A master needs a link, for which `link_patience` is waited; the ring may be there first. Errors as
/// interface_index() and WireLock::take(); Errc::bus when there is no link, or no right to do it.
Result<std::unique_ptr<Port>> open_raw_port(std::string_view interface_name, End end = End::master,
                                            Duration link_patience = kLinkPatience);

/// A port on a socket that carries whole Ethernet frames, one a datagram: AF_PACKET, or one end of a
/// socketpair in tests.
class RawPort final : public Port {
 public:
  /// `lock` is empty where nobody else can be. `name` and `index` are those of the interface.
  RawPort(can::Descriptor socket, std::optional<WireLock> lock, std::string name, End end, int index = 0);

  TimePoint now() const override { return steady_now(); }
  /// Errc::bug for a frame that is too short or too long. Errc::bus also without a link, where the driver
  /// says so.
  Result<void> send(ByteSpan frame) override;
  Result<std::optional<ByteSpan>> receive(TimePoint deadline) override;
  TimePoint arrived() const override { return arrived_; }
  int poll_fd() const override { return socket_.get(); }
  Result<void> recover(TimePoint deadline) override;
  bool has_link() const override;

 private:
  Result<void> open_again();

  can::Descriptor socket_;
  std::optional<WireLock> lock_;
  std::string name_;
  End end_;
  int index_;
  bool waits_in_slices_;
  std::array<std::uint8_t, kLongestFrame> frame_{};
  TimePoint arrived_{};
};

}  // namespace servoctl::ethernet
