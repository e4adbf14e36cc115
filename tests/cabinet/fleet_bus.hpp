#pragma once

#include <atomic>
#include <map>
#include <optional>
#include <random>
#include <utility>

#include "can/bus.hpp"
#include "sim/sim_bus.hpp"
#include "sim/sim_drive.hpp"

namespace servoctl::cabinet {

/// What goes wrong on one bus; numbers are those of the SDO requests that are sent, -1: never.
struct BusTrouble {
  double lose = 0;     ///< Probability, per frame, either way.
  int reset_at = -1;   ///< The drive that is asked restarts.
  int silent_at = -1;  ///< It falls silent.
  int abort_at = -1;   ///< It refuses.
  int cancel_at = -1;  ///< Ctrl-C, on all buses.
  int kill_at = -1;    ///< The process ends: nothing is sent any more, by anybody.
  int lost_at = -1;    ///< The bus is lost.
  unsigned seed = 1;
};

/// What a FleetBus throws where the process is to end.
struct ProcessEnds {};

class FleetBus final : public can::Bus {
 public:
  FleetBus(sim::SimBus& bus, std::map<std::uint8_t, sim::SimDrive*> drives, const BusTrouble& trouble)
      : bus_(&bus), drives_(std::move(drives)), trouble_(trouble), random_(trouble.seed) {}

  TimePoint now() const override { return bus_->now(); }
  TimePoint next_event() const override { return bus_->next_event(); }
  Result<void> send(const can::Frame& frame) override {
    if (killed_) throw ProcessEnds{};
    if (is_lost()) return fail(Errc::bus, "the bus is lost");
    const bool request = frame.id > 0x600 && frame.id < 0x680;
    if (!request) return bus_->send(frame);
    const auto node = static_cast<std::uint8_t>(frame.id & 0x7FU);
    const int number = requests++;
    if (number == trouble_.kill_at) {
      killed_ = true;
      throw ProcessEnds{};
    }
    if (number == trouble_.silent_at && drives_.count(node) > 0)
      drives_.at(node)->wire_faults().silent = true;
    if (number == trouble_.reset_at) {
      auto reset = *can::parse_frame("000#8100");
      reset.data[1] = node;
      (void)bus_->send(reset);
    }
    if (number == trouble_.abort_at) {
      auto refusal = *can::parse_frame("580#8000000000000008");
      refusal.id += node;
      std::copy_n(frame.data.begin() + 1, 3, refusal.data.begin() + 1);
      refusal_ = refusal;
      return {};
    }
    if (chance(trouble_.lose)) return {};
    return bus_->send(frame);
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    if (is_lost()) return fail(Errc::bus, "the bus is lost");
    if (refusal_) return std::exchange(refusal_, std::nullopt);
    for (;;) {
      auto frame = bus_->receive(deadline);
      if (!frame || !*frame || !chance(trouble_.lose)) return frame;
    }
  }
  bool is_cancelled() const { return trouble_.cancel_at >= 0 && requests > trouble_.cancel_at; }

  std::atomic<int> requests{0};  ///< Another bus asks it as well.

 private:
  bool is_lost() const { return trouble_.lost_at >= 0 && requests > trouble_.lost_at; }
  bool chance(double probability) {
    return probability > 0 && std::bernoulli_distribution(probability)(random_);
  }
  sim::SimBus* bus_;
  std::map<std::uint8_t, sim::SimDrive*> drives_;
  BusTrouble trouble_;
  std::mt19937 random_;
  std::optional<can::Frame> refusal_;
  bool killed_ = false;
};

}  // namespace servoctl::cabinet
