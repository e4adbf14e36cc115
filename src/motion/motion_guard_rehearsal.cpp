// What a motion would send to go up and to end, where the drive follows.
#include "drive/standard_objects.hpp"
#include "motion/motion_guard.hpp"

namespace servoctl::motion {

void MotionGuard::rehearse_up(const std::vector<drive::PowerStep>& path) {
  for (const auto& step : path)
    if (step.controlword)
      rehearsal_->add(session::planned_write({node_, objects::kControlword, store_le(*step.controlword, 2)}));
}

/// As PowerDown goes: target zero and halt, a quick stop where neither helps, 07h and 00h; then all is put
/// back.
void MotionGuard::rehearse_end() {
  if (energised_) {
    const auto plan = way_down();
    const bool gently = plan.gentle->halt || plan.gentle->zero_target;
    const auto say = [&](std::uint16_t word, std::string when = {}) {
      rehearsal_->add(
          session::planned_write({node_, objects::kControlword, store_le(word, 2)}, std::move(when)));
    };
    rehearsal_->begin_step("stop");
    if (plan.gentle->zero_target) rehearsal_->add(session::planned_write(*plan.gentle->zero_target));
    if (plan.gentle->halt) say(kHalted);
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
