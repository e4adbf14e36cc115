#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "can/bus.hpp"

namespace servoctl::session {

/// A bus in virtual time on which a test says, frame by frame, what comes after what was sent. Frames are in
/// candump notation.
class ScriptedBus final : public can::Bus {
 public:
  /// Called for each frame sent; answers with arrive().
  std::function<void(ScriptedBus&, const std::string& sent)> on_send;
  std::vector<std::string> sent;
  Duration
      failing{};  ///< What is sent while the bus is lost fails after this time, as where a queue is full.

  /// The frame is received after `delay`.
  void arrive(std::string_view frame, Duration delay = std::chrono::milliseconds(1)) {
    arrive(can::parse_frame(frame).value(), delay);
  }
  void arrive(const can::Frame& frame, Duration delay) {
    const Coming coming{now_ + delay, frame};
    auto at = coming_.end();
    while (at != coming_.begin() && std::prev(at)->time > coming.time) --at;
    coming_.insert(at, coming);
  }

  /// From then on what is sent or received fails; recover() succeeds from `to` on. In the order of time.
  void lose(TimePoint from, TimePoint to) { outages_.push_back({from, to}); }

  TimePoint now() const override { return now_; }
  Result<void> send(const can::Frame& frame) override {
    if (is_lost()) {
      now_ += failing;
      return gone();
    }
    sent.push_back(can::to_string(frame));
    if (on_send) on_send(*this, sent.back());
    return {};
  }
  Result<void> recover(TimePoint deadline) override {
    if (outages_.empty()) return {};
    now_ = std::max(now_, std::min(deadline, outages_.front().to));
    if (now_ < outages_.front().to) return gone();
    outages_.pop_front();
    std::erase_if(coming_, [this](const Coming& coming) { return coming.time < now_; });
    return {};
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    if (!outages_.empty() && (coming_.empty() || coming_.front().time >= outages_.front().from) &&
        outages_.front().from <= std::max(now_, deadline))
      now_ = std::max(now_, outages_.front().from);
    if (is_lost()) return gone();
    if (coming_.empty() || coming_.front().time > deadline) {
      now_ = std::max(now_, std::min(deadline, now_ + std::chrono::hours(1)));
      return std::optional<can::Frame>();
    }
    const auto next = coming_.front();
    coming_.pop_front();
    now_ = std::max(now_, next.time);
    return std::optional(next.frame);
  }

 private:
  struct Coming {
    TimePoint time;
    can::Frame frame;
  };
  struct Outage {
    TimePoint from;
    TimePoint to;
  };
  bool is_lost() const { return !outages_.empty() && now_ >= outages_.front().from; }
  static tl::unexpected<Error> gone() { return fail(Errc::bus, "can0 went down", "bring it up again"); }

  TimePoint now_{std::chrono::seconds(1)};
  std::deque<Coming> coming_;
  std::deque<Outage> outages_;
};

}  // namespace servoctl::session
