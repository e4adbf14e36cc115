#pragma once

#include <sys/types.h>

#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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
/// `patience` for a member whose queue is full; then it loses this frame and those that follow until it reads
/// again, as a CAN controller does that nobody empties, and take_notices() names its process. Errc::bus where
/// a process holds the bus for a second.
Result<std::unique_ptr<Bus>> open_local(std::string_view name,
                                        Duration patience = std::chrono::milliseconds(250));

/// One member of a virtual bus. Not for use in a forked child.
class LocalBus final : public Bus {
 public:
  LocalBus(std::string name, LocalDirectory directory, Descriptor socket, std::string member,
           Duration patience);
  ~LocalBus() override;

  TimePoint now() const override { return steady_now(); }
  Result<void> send(const Frame& frame) override;
  Result<std::optional<Frame>> receive(TimePoint deadline) override;
  int poll_fd() const override { return socket_.get(); }
  TimePoint next_event() const override { return inbox_.empty() ? kNever : TimePoint::min(); }
  std::vector<Message> take_notices() override { return std::exchange(notices_, {}); }

 private:
  std::optional<Frame> take() const;
  void drain();
  bool lock_until(TimePoint limit);
  void deliver_all(std::span<const std::uint8_t> datagram);
  void give_up(const std::vector<std::string>& members);
  bool deliver(std::span<const std::uint8_t> datagram, const std::string& member) const;

  std::string name_;
  LocalDirectory directory_;
  Descriptor socket_;
  std::string member_;
  Duration patience_;
  ::pid_t owner_;
  std::deque<Frame> inbox_;        ///< Received while send() waited for others.
  std::set<std::string> lagging_;  ///< Members whose queue stayed full: nobody waits for them.
  std::vector<Message> notices_;
};

}  // namespace servoctl::can
