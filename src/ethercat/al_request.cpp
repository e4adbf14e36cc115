#include "ethercat/al_request.hpp"

#include <utility>

#include "base/format.hpp"
#include "ethercat/registers.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPoll = 1ms;
/// For a look, and for an error to be acknowledged.
constexpr Duration kShort = 500ms;

Bytes control(AlState state, std::uint16_t bits) {
  return store_le(static_cast<std::uint16_t>(state) | bits, 2);
}

}  // namespace

Duration al_timeout(AlState from, AlState target) {
  if (target == AlState::preop && from == AlState::init) return 3s;
  if (target == AlState::safeop && from == AlState::op) return 1s;
  if (target == AlState::safeop || target == AlState::op) return 10s;
  return 5s;
}

void AlRequest::start(AlState target, TimePoint now, std::optional<Duration> timeout) {
  look_only_ = false;
  target_ = target;
  timeout_ = timeout;
  status_ = {};
  found_.reset();
  until_ = now + kShort;
  go(State::look, now);
}

void AlRequest::start_look(TimePoint now) {
  start(AlState::none, now);
  look_only_ = true;
}

void AlRequest::go(State state, TimePoint now, Duration pause) {
  state_ = state;
  asking_ = pause == Duration{};
  deadline_ = asking_ ? kNever : now + pause;
}

std::optional<Request> AlRequest::take_request() {
  if (!std::exchange(asking_, false)) return std::nullopt;
  switch (state_) {
    case State::idle: return std::nullopt;
    case State::acknowledge:
      return write_registers(slave_, reg::kAlControl, control(status_.state, reg::kAlAcknowledge));
    case State::ask: return write_registers(slave_, reg::kAlControl, control(target_, 0));
    case State::look:
    case State::acknowledged:
    case State::wait: return read_registers(slave_, reg::kAlStatus, reg::kAlStatusSize);
  }
  return std::nullopt;
}

void AlRequest::on_answer(const Answer& answer, TimePoint now) {
  if (state_ == State::idle) return;
  if (!answer.done()) return on_missing(answer.lost, now);
  if (state_ == State::acknowledge) return go(State::acknowledged, now);
  if (state_ == State::ask) return go(State::wait, now);
  on_status(parse_al_status(answer.data), now);
}

/// Each request may be made twice: a burst of lost frames is no reason to give up.
void AlRequest::on_missing(bool lost, TimePoint now) {
  if (now < until_) return go(state_, now, kPoll);
  const auto* what = lost ? "frames do not come back" : "it does not answer";
  finish(fail(
      error(Errc::timeout, what,
            "is it powered, and is the cable leading to it plugged in? `scan` shows which slaves answer")));
}

void AlRequest::on_status(AlStatus status, TimePoint now) {
  status_ = status;
  if (look_only_) return finish(status);
  if (state_ == State::wait) return wait_on(status, now);
  if (status.error && state_ == State::look) {
    found_ = status;
    return go(State::acknowledge, now);
  }
  if (status.error) return now < until_ ? go(State::acknowledged, now, kPoll) : wait_on(status, now);
  if (status.state == target_) return finish(status);
  until_ = now + timeout_.value_or(al_timeout(status.state, target_));
  go(State::ask, now);
}

void AlRequest::wait_on(AlStatus status, TimePoint now) {
  if (status.error)
    return finish(fail(error(Errc::negative,
                             message("{} refused, state is {}: {} (AL status code {:04X}h)", name(target_),
                                     name(status.state), al_status_text(status.code), status.code),
                             al_status_hint(status.code))));
  if (status.state == target_) return finish(status);
  if (now < until_) return go(State::wait, now, kPoll);
  finish(fail(error(
      Errc::timeout, message("{} was requested, state is still {}", name(target_), name(status.state)),
      "it may need more time, or something from the master: process data for OP, settings for SAFE-OP")));
}

void AlRequest::on_time(TimePoint now) {
  if (state_ == State::idle || now < deadline_) return;
  go(state_, now);
}

void AlRequest::finish(Result<AlStatus> result) {
  state_ = State::idle;
  asking_ = false;
  deadline_ = kNever;
  result_ = std::move(result);
}

Error AlRequest::error(Errc code, Message what, Message hint) const {
  return drive_error(code, node_, what, std::move(hint));
}

std::optional<Result<AlStatus>> AlRequest::take_result() { return std::exchange(result_, std::nullopt); }

}  // namespace servoctl::ethercat
