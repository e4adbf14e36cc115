#include "drive/power_path.hpp"

#include <algorithm>
#include <array>
#include <deque>

namespace servoctl::drive {
namespace {

struct Word {
  ControlCommand command;
  std::uint16_t controlword;
};

/// In the order of preference where two lead to the same state.
constexpr std::array kWords{
    Word{ControlCommand::shutdown, 0x06},         Word{ControlCommand::switch_on, 0x07},
    Word{ControlCommand::enable_operation, 0x0F}, Word{ControlCommand::disable_voltage, 0x00},
    Word{ControlCommand::quick_stop, 0x02},
};

std::vector<PowerStep> neighbours(DriveState from, bool resumes) {
  if (from == DriveState::not_ready_to_switch_on) return {{std::nullopt, DriveState::switch_on_disabled}};
  if (from == DriveState::fault_reaction_active) return {{std::nullopt, DriveState::fault}};
  std::vector<PowerStep> out;
  for (const auto& word : kWords) {
    const auto to = next_state(from, word.command);
    const bool two_in_one =
        from == DriveState::ready_to_switch_on && word.command == ControlCommand::enable_operation;
    const bool resuming = from == DriveState::quick_stop_active && to == DriveState::operation_enabled;
    if (to != from && !two_in_one && (resumes || !resuming)) out.push_back({word.controlword, to});
  }
  return out;
}

}  // namespace

std::optional<std::vector<PowerStep>> power_path(DriveState from, DriveState to, bool resumes) {
  struct Way {
    DriveState end;
    std::vector<PowerStep> steps;
  };
  std::deque<Way> ways{{from, {}}};
  std::vector<DriveState> seen{from};
  while (!ways.empty()) {
    const auto way = std::move(ways.front());
    ways.pop_front();
    if (way.end == to) return way.steps;
    for (const auto& step : neighbours(way.end, resumes)) {
      if (std::find(seen.begin(), seen.end(), step.reached) != seen.end()) continue;
      seen.push_back(step.reached);
      auto longer = way.steps;
      longer.push_back(step);
      ways.push_back({step.reached, std::move(longer)});
    }
  }
  return std::nullopt;
}

}  // namespace servoctl::drive
