#include "can/slcan_opening.hpp"

#include <algorithm>
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
    case Opening::State::settling:
    case Opening::State::open:
    case Opening::State::no_answer:
    case Opening::State::refused_bitrate:
    case Opening::State::refused_opening:
    case Opening::State::refused_listening: break;
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
  acknowledges_ = talks_ = echoes_ = false;
  version_.clear();
  enter(State::closing, now);
}

Duration SlcanOpening::patience() const {
  return std::max<Duration>(kPatience * (1 << (round_ - 1)), latency_ + kPatience);
}

void SlcanOpening::enter(State state, TimePoint now) {
  state_ = state;
  entered_ = now;
  to_send_ = command_of(state, bitrate_, mode_);
  if (!to_send_.empty()) unanswered_.push_back({to_send_.front(), now});
  const bool is_silent = !acknowledges_ && (state == State::setting_bitrate || state == State::opening);
  deadline_ = is_done() ? kNever : now + (is_silent ? kPause : patience());
}

std::string SlcanOpening::take_text() { return std::exchange(to_send_, {}); }

void SlcanOpening::on_line(const SlcanLine& line, TimePoint now) {
  // What came in one burst with the line before is no answer to a word that is not sent yet.
  if (is_done() || !to_send_.empty() || echoes_) return;
  switch (line.kind) {
    case SlcanLine::Kind::acknowledged:
    case SlcanLine::Kind::refused:
      on_answer(false, now);
      return line.kind == SlcanLine::Kind::refused ? on_refusal(now) : on_acknowledge(now);
    case SlcanLine::Kind::text: return is_echo(line.text) ? on_echo(now) : on_text(line.text, now);
    case SlcanLine::Kind::damaged: heard_something_ = true; return;
    case SlcanLine::Kind::frame:
    case SlcanLine::Kind::flags:
    case SlcanLine::Kind::report: return;
  }
}

/// One word less waits for its answer; a text is that of the oldest V, and what stood before that is lost.
void SlcanOpening::on_answer(bool is_text, TimePoint now) {
  auto end = unanswered_.begin();
  if (is_text) end = std::find_if(end, unanswered_.end(), [](const Word& word) { return word.first == 'V'; });
  if (end == unanswered_.end()) return;
  latency_ = std::max(latency_, now - end->sent);
  unanswered_.erase(unanswered_.begin(), end + 1);
  deadline_ = std::max(deadline_, entered_ + patience());
}

void SlcanOpening::on_echo(TimePoint now) {
  heard_something_ = true;
  if (state_ == State::setting_bitrate || state_ == State::opening) return begin_round(now);
  echoes_ = true;
  acknowledges_ = false;
}

/// Answers to older words would be taken for those to the next ones.
void SlcanOpening::set_bitrate_when_settled(TimePoint now) {
  if (mode_ == Mode::listen_only && !acknowledges_) return enter(State::refused_listening, now);
  if (!acknowledges_ || unanswered_.empty() || now >= unanswered_.back().sent + latency_ + kPatience) {
    unanswered_.clear();
    return enter(State::setting_bitrate, now);
  }
  if (state_ != State::settling) enter(State::settling, now);
  deadline_ = unanswered_.back().sent + latency_ + kPatience;
}

void SlcanOpening::on_acknowledge(TimePoint now) {
  acknowledges_ = true;
  switch (state_) {
    case State::closing: return enter(State::asking, now);
    case State::settling: return set_bitrate_when_settled(now);
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
    case State::asking_again:
    case State::settling: return set_bitrate_when_settled(now);
    case State::setting_bitrate: return enter(State::refused_bitrate, now);
    case State::opening:
      return enter(mode_ == Mode::normal ? State::refused_opening : State::refused_listening, now);
    default: return;
  }
}

void SlcanOpening::on_text(const std::string& text, TimePoint now) {
  const bool was_asked =
      std::any_of(unanswered_.begin(), unanswered_.end(), [](const Word& word) { return word.first == 'V'; });
  on_answer(true, now);
  talks_ = talks_ || !was_asked;
  if (state_ == State::settling) return set_bitrate_when_settled(now);
  if ((state_ != State::asking && state_ != State::asking_again) || (talks_ && !acknowledges_)) {
    heard_something_ = true;
    return;
  }
  if (state_ == State::asking_again && text != version_) return;  // A device that talks by itself.
  const bool known = acknowledges_ || state_ == State::asking_again;
  version_ = text;
  return known ? set_bitrate_when_settled(now) : enter(State::asking_again, now);
}

void SlcanOpening::on_time(TimePoint now) {
  if (now < deadline_) return;
  switch (state_) {
    case State::closing: return enter(State::asking, now);
    case State::asking:
      // What acknowledges needs no version.
      return acknowledges_ ? set_bitrate_when_settled(now) : begin_round(now);
    case State::settling: return set_bitrate_when_settled(now);
    case State::setting_bitrate: return acknowledges_ ? begin_round(now) : enter(State::opening, now);
    case State::opening: return acknowledges_ ? begin_round(now) : enter(State::open, now);
    default: return begin_round(now);
  }
}

}  // namespace servoctl::can
