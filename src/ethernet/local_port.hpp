#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "can/descriptor.hpp"
#include "can/local_directory.hpp"
#include "ethernet/end.hpp"
#include "ethernet/frame_limits.hpp"
#include "ethernet/port.hpp"

namespace servoctl::ethernet {

/// How long a ring may take to let a master in.
inline constexpr Duration kWelcomePatience = std::chrono::seconds(1);

/// Opens an end of the virtual cable `name`, which leads from one master to one ring, processes of one user
/// on one machine: no kernel driver, no root. Errc::usage for a name as can::check_local_name(). Errc::bus
/// for a master when nobody serves the ring or another master is there, for a ring when another serves it; a
/// process that was killed is neither. A frame for which the other end has no room is lost, as on a wire.
Result<std::unique_ptr<Port>> open_local_port(std::string_view name, End end = End::master,
                                              Duration patience = kWelcomePatience);

/// The master's end. Errc::bus when the ring ends; recover() waits for the next that serves it.
class LocalMaster final : public Port {
 public:
  LocalMaster(std::string name, can::Descriptor socket, ::pid_t ring, Duration patience)
      : name_(std::move(name)), socket_(std::move(socket)), ring_(ring), patience_(patience) {}

  TimePoint now() const override { return steady_now(); }
  Result<void> send(ByteSpan frame) override;
  Result<std::optional<ByteSpan>> receive(TimePoint deadline) override;
  TimePoint arrived() const override { return arrived_; }
  int poll_fd() const override { return socket_.get(); }
  Result<void> recover(TimePoint deadline) override;

 private:
  tl::unexpected<Error> lost() const;
  bool is_connected() const;

  std::string name_;
  can::Descriptor socket_;
  ::pid_t ring_;
  Duration patience_;
  std::array<std::uint8_t, kLongestFrame> frame_{};
  TimePoint arrived_{};
};

/// The ring's end, which masters come to and leave. It has no descriptor to poll: receive() waits for masters
/// and frames alike.
class LocalRing final : public Port {
 public:
  LocalRing(can::LocalDirectory directory, can::Descriptor listener)
      : directory_(std::move(directory)), listener_(std::move(listener)) {}
  ~LocalRing() override;

  TimePoint now() const override { return steady_now(); }
  /// Does nothing where there is no master.
  Result<void> send(ByteSpan frame) override;
  Result<std::optional<ByteSpan>> receive(TimePoint deadline) override;
  TimePoint arrived() const override { return arrived_; }
  Result<void> recover(TimePoint) override { return {}; }
  /// Whether a master is there.
  bool has_link() const override { return static_cast<bool>(master_); }

 private:
  std::optional<ByteSpan> take();
  void let_in();

  can::LocalDirectory directory_;  ///< Locked, as long as the ring is served.
  can::Descriptor listener_;
  can::Descriptor master_;
  std::array<std::uint8_t, kLongestFrame> frame_{};
  TimePoint arrived_{};
};

}  // namespace servoctl::ethernet
