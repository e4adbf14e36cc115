#pragma once

#include <sys/types.h>

#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "base/time.hpp"
#include "can/bus.hpp"
#include "can/descriptor.hpp"
#include "can/frame.hpp"
#include "can/local_directory.hpp"

namespace servoctl::can {

/// Joins the virtual bus `name`, which the processes of one user on one machine share without kernel CAN and
/// without a daemon. What one member sends reaches all others that have joined before, in one order for all,
/// and not itself. `name` has 1 to 32 of A-Z a-z 0-9 . _ - (Errc::usage otherwise). send() waits up to
/// `send_limit` for a member that does not read; Errc::bus then, although the other members got the frame.
Result<std::unique_ptr<Bus>> open_local(std::string_view name, Duration send_limit = std::chrono::seconds(1));

/// One member of a virtual bus. Not for use in a forked child.
class LocalBus final : public Bus {
 public:
  LocalBus(std::string name, LocalDirectory directory, Descriptor socket, std::string member,
           Duration send_limit);
  ~LocalBus() override;

  TimePoint now() const override { return steady_now(); }
  Result<void> send(const Frame& frame) override;
  Result<std::optional<Frame>> receive(TimePoint deadline) override;
  int poll_fd() const override { return socket_.get(); }
  TimePoint next_event() const override { return inbox_.empty() ? kNever : TimePoint::min(); }

 private:
  std::optional<Frame> take() const;
  void drain();
  bool lock_until(TimePoint limit);
  Result<void> deliver_all(std::span<const std::uint8_t> datagram, TimePoint limit);
  bool deliver(std::span<const std::uint8_t> datagram, const std::string& member) const;

  std::string name_;
  LocalDirectory directory_;
  Descriptor socket_;
  std::string member_;
  Duration send_limit_;
  ::pid_t owner_;
  std::deque<Frame> inbox_;  ///< Received while send() waited for others.
};

}  // namespace servoctl::can
