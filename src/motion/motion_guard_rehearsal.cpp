// What a motion would send to go up and to end, where the drive follows.
#include <algorithm>

#include "drive/standard_objects.hpp"
#include "motion/motion_guard.hpp"

namespace servoctl::motion {

void MotionGuard::rehearse_up(const std::vector<drive::PowerStep>& path) {
  for (const auto& step : path)
    if (step.controlword)
      rehearsal_->add(session::planned_write({node_, objects::kControlword, store_le(*step.controlword, 2)}));
}

/// As PowerDown goes: halt or target zero, a quick stop where neither helps, 07h and 00h; then all is put
/// back.
void MotionGuard::rehearse_end() {
  if (energised_) {
    const auto plan = way_down();
    const auto* mode = rehearsal_->held(objects::kModeOfOperation);
    const auto number = mode != nullptr ? static_cast<std::int8_t>(load_le(*mode)) : std::int8_t{0};
    const auto& targets = plan.gentle->targets;
    const auto target =
        std::find_if(targets.begin(), targets.end(), [&](const auto& each) { return each.first == number; });
    const bool gently = plan.gentle->halt || target != targets.end();
    const auto say = [&](std::uint16_t word, std::string when = {}) {
      rehearsal_->add(
          session::planned_write({node_, objects::kControlword, store_le(word, 2)}, std::move(when)));
    };
    rehearsal_->begin_step("stop");
    if (plan.gentle->halt) say(kHalted);
    if (target != targets.end()) rehearsal_->add(session::planned_write(target->second));
    say(kQuickStopWord, gently ? "if it does not slow down" : "");
    rehearsal_->begin_step("disable");
    say(kSwitchOffWord, "if it is still enabled");
    say(kDisableVoltageWord);
  }
  rehearsal_->begin_step("put back");
  for (auto changed = changed_.rbegin(); changed != changed_.rend(); ++changed)
    if (!stays_new(*changed))
      rehearsal_->add(session::planned_write({node_, changed->object, changed->before}));
  if (started_ && state_before_)
    rehearsal_->add(session::planned_state(node_, session::NodeState::pre_operational));
}

}  // namespace servoctl::motion
