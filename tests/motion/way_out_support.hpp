#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "motion_support.hpp"
#include "session/can_network.hpp"

namespace servoctl::motion {

struct EnabledFamily {
  const char* name;
  double turn;
};
inline constexpr EnabledFamily kEnabledFamilies[] = {{"cia402", 10000}, {"gsd600", 131072}, {"da200", 10000},
                                                     {"ts", 10000},     {"sv2", 131072},    {"dm", 0}};
inline std::string name_of(const testing::TestParamInfo<EnabledFamily>& one) { return one.param.name; }

/// Several drives of one family, enabled, each of which answers after 3 ms.
class Several {
 public:
  Several(const char* family, int count) {
    std::string spec;
    for (int node = count; node >= 1; --node)
      spec += std::string(spec.empty() ? "" : ",") + family + (node == 1 ? "" : "@" + std::to_string(node));
    auto owned = std::make_unique<MotionBus>(spec);
    bus = owned.get();
    session = std::make_unique<session::Session>(std::move(owned), "test", session::Options{});
    EXPECT_TRUE(session->listen());
    for (int node = 1; node <= count; ++node) {
      nodes.push_back(static_cast<std::uint8_t>(node));
      const auto& profile = *bus->cell.profiles.front();
      if (profile.rules.nmt.disables_outside_operational) {
        EXPECT_TRUE(session->can()->send(canopen::nmt_frame(canopen::NmtCommand::start, nodes.back())));
      }
      EXPECT_TRUE(Power(*session, profile, nodes.back()).reach(drive::DriveState::operation_enabled));
      session->energised().insert(nodes.back());
    }
    for (const auto& one : bus->cell.drives) one->wire_faults().answer_delay = std::chrono::milliseconds(3);
    bus->frames.clear();
  }

  sim::SimDrive& drive(std::uint8_t node) {
    return **std::find_if(bus->cell.drives.begin(), bus->cell.drives.end(),
                          [&](const auto& one) { return one->node() == node; });
  }
  std::vector<PowerDownResult> take_down(PowerAim aim) {
    std::vector<PowerDownPlan> plans;
    for (const auto node : nodes) {
      plans.emplace_back();
      plans.back().node = node;
      plans.back().aim = aim;
    }
    begun = session->now();
    auto out = motion::take_down(*session, std::move(plans));
    took = session->now() - begun;
    return out;
  }

  MotionBus* bus = nullptr;
  std::unique_ptr<session::Session> session;
  std::vector<std::uint8_t> nodes;
  TimePoint begun{};
  Duration took{};
};

class WayOut : public testing::TestWithParam<EnabledFamily> {
 protected:
  const char* family() const { return GetParam().name; }
};

}  // namespace servoctl::motion
