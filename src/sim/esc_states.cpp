#include "sim/esc_states.hpp"

#include <utility>

namespace servoctl::sim {
namespace {

constexpr std::uint16_t kStateMask = 0x0F;
constexpr std::uint16_t kErrorBit = 0x10;  ///< Of 0120h: acknowledges; of 0130h: something went wrong.

}  // namespace

void EscStates::reset() {
  state_ = EscState::init;
  error_ = false;
  code_ = al_code::kNone;
  op_until_ = kNever;
}

std::uint16_t EscStates::status() const {
  return static_cast<std::uint16_t>(static_cast<unsigned>(state_) | (error_ ? kErrorBit : 0U));
}

/// An error that stands has to be acknowledged before, or with, another request; INIT needs no such word.
void EscStates::on_control(std::uint16_t control, TimePoint now) {
  const unsigned wanted = control & kStateMask;
  const bool acknowledges = (control & kErrorBit) != 0;
  if (error_ && !acknowledges && wanted != static_cast<unsigned>(EscState::init)) return;
  error_ = false;
  code_ = al_code::kNone;
  op_until_ = kNever;
  if (const auto code = refusal(wanted); code != 0) return refuse(code);
  request(static_cast<EscState>(wanted), now);
}

/// A step that no slave takes, whatever its settings; this one has no boot loader.
std::uint16_t EscStates::refusal(unsigned wanted) const {
  switch (wanted) {
    case static_cast<unsigned>(EscState::init):
    case static_cast<unsigned>(EscState::pre_op): return al_code::kNone;
    case static_cast<unsigned>(EscState::boot):
      if (state_ == EscState::boot) return al_code::kNone;  // Its error is acknowledged.
      return state_ == EscState::init ? al_code::kNoBoot : al_code::kInvalidChange;
    case static_cast<unsigned>(EscState::safe_op):
      return state_ == EscState::init ? al_code::kInvalidChange : al_code::kNone;
    case static_cast<unsigned>(EscState::op):
      return state_ < EscState::safe_op ? al_code::kInvalidChange : al_code::kNone;
    default: return al_code::kUnknownState;
  }
}

/// What a state needs of the sync managers.
std::uint16_t EscStates::missing_for(EscState state) {
  if (state == EscState::init) return al_code::kNone;
  if (const auto code = application_->check_mailboxes(); code != 0) return code;
  return state >= EscState::safe_op ? application_->check_process_data() : al_code::kNone;
}

void EscStates::request(EscState wanted, TimePoint now) {
  if (const auto code = missing_for(wanted); code != 0) {
    // Where not even the present state has what it needs, it ends.
    if (state_ >= wanted) on_settings_changed();
    return refuse(code);
  }
  if (wanted != EscState::op || state_ == EscState::op) return enter(wanted);
  if (const auto code = application_->check_synchronisation(); code != 0) return refuse(code);
  op_until_ = now + kOutputsPatience;
  on_time(now);
}

void EscStates::on_time(TimePoint now) {
  if (op_until_ == kNever) return;
  if (application_->outputs_arrive()) {
    op_until_ = kNever;
    return enter(EscState::op);
  }
  if (now < op_until_) return;
  op_until_ = kNever;
  refuse(al_code::kWatchdog);
}

void EscStates::on_settings_changed() {
  if (state_ == EscState::init) return;
  if (const auto code = application_->check_mailboxes(); code != 0) return fall_to(EscState::init, code);
  if (state_ < EscState::safe_op) return;
  if (const auto code = application_->check_process_data(); code != 0) fall_to(EscState::pre_op, code);
}

void EscStates::fall_to(EscState state, std::uint16_t code) {
  if (state_ <= state) return;
  op_until_ = kNever;
  enter(state);
  refuse(code);
}

void EscStates::enter(EscState state) {
  const auto from = std::exchange(state_, state);
  if (from != state) application_->on_state(from, state);
}

void EscStates::refuse(std::uint16_t code) {
  error_ = true;
  code_ = code;
}

}  // namespace servoctl::sim
