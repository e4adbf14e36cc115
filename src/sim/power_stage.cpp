#include "sim/power_stage.hpp"

#include <algorithm>

namespace servoctl::sim {
namespace {

using drive::ControlCommand;
using drive::DriveState;

constexpr Duration kReaction = std::chrono::milliseconds(20);

}  // namespace

void PowerStage::reset() {
  state_ = DriveState::switch_on_disabled;
  controlword_ = 0;
  deadline_ = kNever;
}

void PowerStage::on_controlword(std::uint16_t controlword, std::int64_t quick_stop_option, bool may_reset,
                                TimePoint now) {
  const auto command = drive::decode_command(controlword, controlword_);
  controlword_ = controlword;
  was_reset_ = false;
  if (torque_off_ && command != ControlCommand::fault_reset) return;
  if (command == ControlCommand::fault_reset && !may_reset) return;
  const auto before = state_;
  const bool stopping = state_ == DriveState::quick_stop_active && deadline_ != kNever;
  if (stopping && command == ControlCommand::enable_operation) return;
  state_ = drive::next_state(state_, command);
  was_reset_ = before == DriveState::fault && state_ != before;
  if (state_ == before) return;
  deadline_ = kNever;
  if (state_ != DriveState::quick_stop_active) return;
  const auto& staying = rules_->quick_stop_stays_enabled;
  stays_enabled_ = std::find(staying.begin(), staying.end(), quick_stop_option) != staying.end();
  deadline_ = now + kReaction;
}

void PowerStage::raise_fault(TimePoint now) {
  if (state_ == DriveState::fault || state_ == DriveState::fault_reaction_active) return;
  state_ = DriveState::fault_reaction_active;
  deadline_ = now + kReaction;
}

void PowerStage::stop_until(TimePoint end) {
  if (deadline_ != kNever) deadline_ = std::max(deadline_, end);
}

bool PowerStage::reset_fault() {
  if (state_ != DriveState::fault) return false;
  state_ = DriveState::switch_on_disabled;
  return true;
}

void PowerStage::disable() {
  if (state_ == DriveState::fault || state_ == DriveState::fault_reaction_active) return;
  state_ = DriveState::switch_on_disabled;
  deadline_ = kNever;
}

void PowerStage::set_torque_off(bool off) {
  if (off == torque_off_) return;
  torque_off_ = off;
  if (off) return disable();
  const bool says_go = drive::decode_command(controlword_, controlword_) == ControlCommand::enable_operation;
  if (says_go && state_ == DriveState::switch_on_disabled) state_ = DriveState::operation_enabled;
}

void PowerStage::on_time(TimePoint now) {
  if (now < deadline_) return;
  deadline_ = kNever;
  if (state_ == DriveState::fault_reaction_active) state_ = DriveState::fault;
  if (state_ == DriveState::quick_stop_active && !stays_enabled_) state_ = DriveState::switch_on_disabled;
}

std::uint16_t PowerStage::statusword(std::int8_t mode) const {
  const auto base = rules_->statusword[static_cast<std::size_t>(state_)];
  const bool disabled = state_ == DriveState::ready_to_switch_on || state_ == DriveState::switched_on;
  for (const auto& row : rules_->mode_bits)
    if (row.mode == mode && disabled) return static_cast<std::uint16_t>(base | row.disabled);
  return base;
}

}  // namespace servoctl::sim
