#include "can/socketcand_dialogue.hpp"

#include <utility>

namespace servoctl::can {
namespace {

constexpr std::string_view kEcho = "< echo >";

}  // namespace

void SocketcandDialogue::enter(State state, std::string text, TimePoint now) {
  state_ = state;
  to_send_ += text;
  deadline_ = now + (state == State::testing_echo ? kEchoPatience : kPatience);
  if (state == State::raw) deadline_ = echoes_ ? now + kQuiet : kNever;
  if (state > State::raw) deadline_ = kNever;
}

void SocketcandDialogue::on_element(const SocketcandElement& element, TimePoint now) {
  using Kind = SocketcandElement::Kind;
  if (state_ > State::raw) return;
  if (state_ < State::testing_echo && element.kind == Kind::refusal) {
    why_ = element.text;
    return enter(State::refused, {}, now);
  }
  switch (state_) {
    case State::greeted:
      if (element.kind == Kind::hi) return enter(State::opening, "< open " + interface_name_ + " >", now);
      return enter(State::stranger, {}, now);
    case State::opening:
      if (element.kind == Kind::ok) enter(State::entering_raw_mode, "< rawmode >", now);
      return;
    case State::entering_raw_mode:
      if (element.kind == Kind::ok) enter(State::testing_echo, std::string(kEcho), now);
      return;
    case State::testing_echo:
      echoes_ = element.kind == Kind::echo;
      if (echoes_ || element.kind == Kind::refusal) enter(State::raw, {}, now);
      return;
    default:
      if (element.kind == Kind::echo) on_echo(now);
  }
}

void SocketcandDialogue::on_echo(TimePoint now) {
  if (!echoes_out_.empty()) {
    read_ = echoes_out_.front();
    echoes_out_.pop_front();
  }
  on_life(now);
}

void SocketcandDialogue::on_life(TimePoint now) {
  if (state_ != State::raw || !echoes_) return;
  deadline_ = now + (echoes_out_.empty() ? kQuiet : kPatience);
}

void SocketcandDialogue::ask_for_echo(TimePoint now) {
  if (echoes_out_.empty()) deadline_ = now + kPatience;
  to_send_ += kEcho;
  sent_ += kEcho.size();
  echoes_out_.push_back(sent_);
}

void SocketcandDialogue::on_sent(std::size_t size, TimePoint now) {
  sent_ += size;
  if (!echoes_) return;
  const auto asked = echoes_out_.empty() ? read_ : echoes_out_.back();
  if (sent_ - asked >= kWindow / 4) ask_for_echo(now);
}

void SocketcandDialogue::on_time(TimePoint now) {
  if (now < deadline_) return;
  if (state_ == State::testing_echo) return enter(State::raw, {}, now);
  if (state_ == State::raw && echoes_out_.empty()) {
    ask_for_echo(now);
    return;
  }
  enter(State::silent, {}, now);
}

}  // namespace servoctl::can
