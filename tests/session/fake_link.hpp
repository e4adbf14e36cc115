#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "can/link_change.hpp"

namespace servoctl::session {

/// A bus on which is heard, in virtual time, what a test says: frames that come one after the other, so
/// often.
class HeardBus final : public can::Bus {
 public:
  /// `clock` goes on while somebody waits.
  HeardBus(TimePoint& clock, std::vector<can::Frame> frames, Duration period)
      : clock_(&clock), frames_(frames.begin(), frames.end()), period_(period), next_(clock + period) {}

  TimePoint now() const override { return *clock_; }
  Result<void> send(const can::Frame& frame) override {
    sent.push_back(frame);
    return {};
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    if (frames_.empty() || next_ > deadline) {
      *clock_ = std::max(*clock_, deadline);
      return std::optional<can::Frame>();
    }
    *clock_ = std::max(*clock_, next_);
    next_ = *clock_ + period_;
    auto out = frames_.front();
    frames_.pop_front();
    return std::optional(out);
  }

  std::vector<can::Frame> sent;

 private:
  TimePoint* clock_;
  std::deque<can::Frame> frames_;
  Duration period_;
  TimePoint next_;
};

/// An interface of the kernel without a kernel: keeps the settings, writes down what is done, and refuses
/// what a test wants refused.
class FakeLink final : public can::LinkControl {
 public:
  explicit FakeLink(can::LinkState state) : now(std::move(state)) {}

  const std::string& name() const override { return name_; }
  Result<can::LinkState> state() override { return now; }
  Result<void> change(const can::LinkChange& change) override {
    done.push_back(can::ip_command(name_, change).substr(std::string("ip link set can0").size()));
    if (const auto refused = refuses ? refuses(change) : 0; refused != 0)
      return fail(can::link_refusal(name_, change, now, refused, {}));
    const bool sets = change.bitrate || change.restart_ms || change.listen_only;
    if (sets && now.up) return fail(can::link_refusal(name_, change, now, EBUSY, {}));
    if (change.bitrate) now.bitrate = makes ? makes(*change.bitrate) : *change.bitrate;
    if (change.bitrate) now.sample_point = change.sample_point.value_or(875);
    if (change.restart_ms) now.restart_ms = change.restart_ms;
    if (change.listen_only) now.listen_only = *change.listen_only;
    if (change.queue_length) now.queue_length = *change.queue_length;
    if (change.up) now.up = *change.up;
    if (change.up) now.health = now.up ? can::LinkHealth::error_active : can::LinkHealth::stopped;
    return {};
  }
  Result<std::unique_ptr<can::Bus>> listen() override {
    const auto at = now.bitrate.value_or(0);
    listened.push_back(at);
    listened_only = listened_only && now.listen_only;
    return std::make_unique<HeardBus>(clock, on_wire[at], std::chrono::milliseconds(100));
  }

  can::LinkState now;
  std::vector<std::string> done;  ///< Behind `ip link set can0`.
  std::function<int(const can::LinkChange&)> refuses;
  std::function<std::uint32_t(std::uint32_t)> makes;         ///< What its clock makes of a bitrate.
  std::map<std::uint32_t, std::vector<can::Frame>> on_wire;  ///< What is heard, by bitrate.
  std::vector<std::uint32_t> listened;
  bool listened_only = true;
  TimePoint clock{};

 private:
  std::string name_ = "can0";
};

/// A controller that is up at a bitrate, or down.
inline can::LinkState controller(bool up, std::optional<std::uint32_t> bitrate = 500'000) {
  can::LinkState out;
  out.kind = "can";
  out.up = up;
  out.bitrate = bitrate;
  if (bitrate) out.sample_point = 875;
  out.quanta = 16;
  out.clock = 8'000'000;
  out.restart_ms = 0;
  out.queue_length = 10;
  out.health = up ? can::LinkHealth::error_active : can::LinkHealth::stopped;
  return out;
}

}  // namespace servoctl::session
