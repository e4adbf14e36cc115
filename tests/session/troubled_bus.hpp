#pragma once

#include <algorithm>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "can/bus.hpp"
#include "sim/sim_bus.hpp"
#include "sim/sim_drive.hpp"

namespace servoctl::session {

/// What may go wrong; each is a probability per frame, or the number of the frame at which it happens.
struct Trouble {
  double lose = 0;
  double repeat = 0;
  double late = 0;  ///< A frame arrives when nobody waits for it any more.
  int reset_at = -1;
  int silent_at = -1;
  int abort_at = -1;
  int cancel_at = -1;
  std::optional<ObjectAddress> stuck = {};  ///< Of one byte or two: what is written to it is what it was.
  int kill_at = -1;  ///< The process ends: an exception, and nothing is sent or heard after it.
};

/// The interface is down for a time: what is sent or received fails, and the drives go on without it.
struct Outage {
  TimePoint from = kNever;
  TimePoint to = kNever;

  bool covers(TimePoint now) const { return now >= from && now < to; }
  /// As Bus::recover(): lets the time pass on the bus behind it.
  Result<void> pass(sim::SimBus& bus, TimePoint deadline) const {
    const auto end = std::min(deadline, to);
    while (bus.now() < end) (void)bus.receive(end);
    while (*bus.receive(bus.now())) {
    }
    if (covers(bus.now())) return fail(Errc::bus, "vcan0 is down");
    return {};
  }
};

/// What a TroubledBus throws where the process is to end.
struct Killed {};

/// A simulated bus on which things go wrong.
class TroubledBus final : public can::Bus {
 public:
  TroubledBus(sim::SimBus& bus, sim::SimDrive& drive, const Trouble& trouble, unsigned seed)
      : bus_(&bus), drive_(&drive), trouble_(trouble), random_(seed) {}

  TimePoint now() const override { return bus_->now(); }
  TimePoint next_event() const override { return bus_->next_event(); }
  Result<void> send(const can::Frame& frame) override {
    if (killed_) return {};
    const int number = frames_++;
    if (number == trouble_.kill_at) {
      killed_ = true;
      throw Killed{};
    }
    sent_.push_back(can::to_string(frame));
    if (number == trouble_.silent_at) drive_->wire_faults().silent = true;
    if (number == trouble_.reset_at) (void)bus_->send(*can::parse_frame("000#8101"));
    if (number == trouble_.abort_at) {
      // Refused on its way: the drive never sees it.
      auto refusal = *can::parse_frame("581#8000000000000008");
      std::copy_n(frame.data.begin() + 1, 3, refusal.data.begin() + 1);
      waiting_ = refusal;
      return {};
    }
    if (chance(trouble_.lose)) return {};
    return bus_->send(is_to_stuck(frame) ? as_it_is(frame) : frame);
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    if (killed_) return bus_->receive(deadline);
    if (waiting_) return std::exchange(waiting_, std::nullopt);
    for (;;) {
      if (late_ && now() >= late_->second) return std::optional(std::exchange(late_, std::nullopt)->first);
      auto frame = bus_->receive(late_ ? std::min(deadline, late_->second) : deadline);
      if (!frame) return frame;
      if (!*frame && late_ && now() >= late_->second) continue;
      if (!*frame) return frame;
      if (chance(trouble_.lose)) continue;
      if (!late_ && chance(trouble_.late)) {
        late_ = {**frame, now() + kLateness};
        continue;
      }
      if (chance(trouble_.repeat)) waiting_ = **frame;
      return frame;
    }
  }
  int frames() const { return frames_; }
  /// In candump notation, whatever became of them.
  const std::vector<std::string>& sent() const { return sent_; }

 private:
  bool is_to_stuck(const can::Frame& frame) const {
    return trouble_.stuck && frame.id == 0x601 && (frame.data[0] & 0xE0U) == 0x20U &&
           (frame.data[1] | frame.data[2] << 8U) == trouble_.stuck->index &&
           frame.data[3] == trouble_.stuck->sub;
  }
  /// 0 and 1 are all that a switch has.
  static can::Frame as_it_is(can::Frame frame) {
    frame.data[4] ^= 1U;
    return frame;
  }

  /// Longer than the patience for an answer.
  static constexpr Duration kLateness = std::chrono::milliseconds(700);

  bool chance(double probability) { return std::bernoulli_distribution(probability)(random_); }

  sim::SimBus* bus_;
  sim::SimDrive* drive_;
  Trouble trouble_;
  std::mt19937 random_;
  std::optional<can::Frame> waiting_;
  std::optional<std::pair<can::Frame, TimePoint>> late_;
  int frames_ = 0;
  bool killed_ = false;
  std::vector<std::string> sent_;
};

}  // namespace servoctl::session
