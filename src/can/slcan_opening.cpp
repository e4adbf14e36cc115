#include "can/slcan_opening.hpp"

#include <string_view>
#include <utility>

namespace servoctl::can {
namespace {

using Opening = SlcanOpening;

std::string command_of(Opening::State state, char bitrate, Opening::Mode mode) {
  switch (state) {
    case Opening::State::closing: return "C\r";
    case Opening::State::asking:
    case Opening::State::asking_again: return "V\r";
    case Opening::State::setting_bitrate: return std::string("S") + bitrate + '\r';
    case Opening::State::opening: return mode == Opening::Mode::normal ? "O\r" : "L\r";
    case Opening::State::open:
    case Opening::State::no_answer:
    case Opening::State::refused_bitrate:
    case Opening::State::refused_opening: break;
  }
  return {};
}

/// What a port says back that sends to itself, or a device that echoes.
bool is_echo(std::string_view text) {
  return text == "C" || text == "V" || text == "O" || text == "L" || (text.size() == 2 && text[0] == 'S');
}

}  // namespace

SlcanOpening::SlcanOpening(char bitrate, Mode mode, TimePoint now) : bitrate_(bitrate), mode_(mode) {
  begin_round(now);
}

void SlcanOpening::begin_round(TimePoint now) {
  if (round_ == kRounds) return enter(State::no_answer, now);
  ++round_;
  acknowledges_ = false;
  version_.clear();
  enter(State::closing, now);
}

void SlcanOpening::enter(State state, TimePoint now) {
  state_ = state;
  to_send_ = command_of(state, bitrate_, mode_);
  const bool is_silent = !acknowledges_ && (state == State::setting_bitrate || state == State::opening);
  deadline_ = is_done() ? kNever : now + (is_silent ? kPause : kPatience * (1 << (round_ - 1)));
}

std::string SlcanOpening::take_text() { return std::exchange(to_send_, {}); }

void SlcanOpening::on_line(const SlcanLine& line, TimePoint now) {
  // What came in one burst with the line before is no answer to a word that is not sent yet.
  if (is_done() || !to_send_.empty()) return;
  switch (line.kind) {
    case SlcanLine::Kind::acknowledged: return on_acknowledge(now);
    case SlcanLine::Kind::refused: return on_refusal(now);
    case SlcanLine::Kind::text: return on_text(line.text, now);
    case SlcanLine::Kind::damaged: heard_something_ = true; return;
    case SlcanLine::Kind::frame:
    case SlcanLine::Kind::flags:
    case SlcanLine::Kind::report: return;
  }
}

void SlcanOpening::on_acknowledge(TimePoint now) {
  acknowledges_ = true;
  switch (state_) {
    case State::closing: return enter(State::asking, now);
    case State::setting_bitrate: return enter(State::opening, now);
    case State::opening: return enter(State::open, now);
    default: return;
  }
}

/// C is refused by an adapter that is closed, V by one that has none.
void SlcanOpening::on_refusal(TimePoint now) {
  acknowledges_ = true;
  switch (state_) {
    case State::closing: return enter(State::asking, now);
    case State::asking:
    case State::asking_again: return enter(State::setting_bitrate, now);
    case State::setting_bitrate: return enter(State::refused_bitrate, now);
    case State::opening: return enter(State::refused_opening, now);
    default: return;
  }
}

void SlcanOpening::on_text(const std::string& text, TimePoint now) {
  const bool asked = state_ == State::asking || state_ == State::asking_again;
  if (!asked || is_echo(text)) {
    heard_something_ = true;
    return;
  }
  if (state_ == State::asking_again && text != version_) return;  // A device that talks by itself.
  const bool known = acknowledges_ || state_ == State::asking_again;
  version_ = text;
  enter(known ? State::setting_bitrate : State::asking_again, now);
}

void SlcanOpening::on_time(TimePoint now) {
  if (now < deadline_) return;
  switch (state_) {
    case State::closing: return enter(State::asking, now);
    case State::asking:
      // What acknowledges needs no version.
      return acknowledges_ ? enter(State::setting_bitrate, now) : begin_round(now);
    case State::setting_bitrate: return acknowledges_ ? begin_round(now) : enter(State::opening, now);
    case State::opening: return acknowledges_ ? begin_round(now) : enter(State::open, now);
    default: return begin_round(now);
  }
}

}  // namespace servoctl::can
