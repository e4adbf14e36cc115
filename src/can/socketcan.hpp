#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "can/bus.hpp"
#include "can/descriptor.hpp"
#include "can/frame.hpp"

struct can_frame;  // linux/can.h

namespace servoctl::can {

/// How long send() tries while the transmit queue is full.
inline constexpr Duration kSendLimit = std::chrono::seconds(1);

/// Opens a CAN interface of the kernel, such as `can0`. Received are data and remote frames, also those that
/// other programs of this machine send, and reports of the controller: bus-off, restart, error state,
/// transmit time-out. CAN FD frames are counted. Frames that were lost because receive() came too late are
/// reported as an overflow of the controller (class 004h, data[1] = 01h). Errc::usage when the name cannot be
/// that of an interface; Errc::bus when the interface is missing, down or no CAN interface, or when the
/// kernel has no CAN.
Result<std::unique_ptr<Bus>> open_socketcan(std::string_view interface_name);

/// The socket of open_socketcan(); errors as there.
Result<Descriptor> socketcan_socket(const std::string& name);

/// Whether a controller takes part in its bus: one that is bus-off has no carrier, and what is sent then is
/// dropped without an error. Empty where it is not known, as for an interface that is down.
std::optional<bool> socketcan_carrier(const std::string& name);

/// The same for one who only listens: with every report of the controller, the errors on the wire among them
/// where its driver tells them.
Result<std::unique_ptr<Bus>> open_socketcan_listener(const std::string& name);

/// Whether this is the name of a CAN interface of this machine, up or down.
bool is_can_interface(const std::string& name);

/// The CAN interfaces of this machine, up or down, in alphabetical order.
std::vector<std::string> can_interfaces();

/// A bus on a socket that carries `struct can_frame` and `struct canfd_frame`, one a datagram: CAN_RAW, or
/// one end of a socketpair in tests.
class SocketCanBus final : public Bus {
 public:
  /// `interface_name` is used in messages. The socket is made a blocking one whose recv() ends after a while.
  SocketCanBus(Descriptor socket, std::string interface_name, Duration send_limit = kSendLimit);

  TimePoint now() const override { return steady_now(); }
  /// Errc::bug for a frame that is not one of ISO 11898-1: a report of the controller, or an identifier or a
  /// size out of range. A driver would put something else on the bus for it. Errc::bus also from the report
  /// of a bus-off to that of a restart: the kernel drops such frames in silence.
  Result<void> send(const Frame& frame) override;
  Result<std::optional<Frame>> receive(TimePoint deadline) override;
  Result<void> recover(TimePoint deadline) override;
  TimePoint arrived() const override { return arrived_; }
  void gather(Duration delay) override { delay_ = delay; }
  int poll_fd() const override { return socket_.get(); }
  /// How many CAN FD frames came: receive() does not give them, CANopen has none.
  std::vector<Message> take_notices() override;
  std::uint64_t fd_frames() const override { return fd_frames_; }
  TimePoint next_event() const override { return inbox_.empty() ? kNever : TimePoint::min(); }

 private:
  Wake wait_for_frames(TimePoint deadline);
  enum class Take : std::uint8_t {
    present,  ///< What is there now.
    awaited,  ///< The first, for which a slice is waited, and what came with it.
  };
  Result<void> fill(Take which);
  void drain(Take take = Take::present);
  void note_bus_off(const Frame& frame);
  void take(const ::can_frame& raw, std::optional<std::uint32_t> lost_in_all, TimePoint time);

  Descriptor socket_;
  std::string interface_name_;
  Duration send_limit_;
  std::uint64_t fd_frames_ = 0;    ///< Since it was opened.
  std::uint64_t told_fd_ = 0;      ///< Of them the notices have said so many.
  std::uint32_t lost_frames_ = 0;  ///< As last told by the kernel.
  bool waits_in_slices_ = false;   ///< recv() of the socket ends after a slice.
  bool is_bus_off_ = false;        ///< As last reported, until it takes part again.
  struct Received {
    Frame frame;
    TimePoint time;
  };
  std::deque<Received> inbox_;   ///< Received, not given yet.
  std::optional<Error> failed_;  ///< What ended drain(); told when the inbox is empty.
  std::size_t given_ = 0;        ///< Frames out of the inbox since drain().
  Duration delay_{};             ///< See gather().
  TimePoint arrived_{};
};

}  // namespace servoctl::can
