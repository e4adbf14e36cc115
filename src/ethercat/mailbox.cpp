#include "ethercat/mailbox.hpp"

#include <algorithm>
#include <utility>

#include "ethercat/registers.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

constexpr Duration kLongestPause = 1ms;
/// Between looks at a slave that is not there while nobody waits for it.
constexpr Duration kUnanswered = 100ms;

/// From the status of SM0 to that of SM1's processor side: one read shows all.
constexpr std::uint16_t kStatus = reg::sm_status(0);
constexpr std::size_t kStatusSize = reg::sm_processor(1) - kStatus + 1;
constexpr std::size_t kSm1Status = reg::sm_status(1) - kStatus;
constexpr std::size_t kSm1Activate = reg::sm_activate(1) - kStatus;
constexpr std::size_t kSm1Processor = reg::sm_processor(1) - kStatus;

}  // namespace

Mailbox::Mailbox(std::uint8_t node, SlaveAddress slave, const Options& options)
    : node_(node), slave_(slave), options_(options) {}

void Mailbox::start(TimePoint now) {
  draining_ = true;
  full_ = false;
  free_ = false;
  answered_ = false;
  counts_ = false;
  skipped_ = false;
  in_doubt_ = false;
  uncounted_ = false;
  last_.clear();
  recovery_ = Recovery::none;
  counter_ = options_.first_counter;
  waiting_since_ = now;
  out_.reset();
  writing_.reset();
  events_.clear();
  if (!under_way_) go(State::look, now);
}

void Mailbox::send(Bytes message, TimePoint until, TimePoint now) {
  out_ = {std::move(message), until};
  waiting_since_ = now;
  look_about(now);
}

void Mailbox::cancel() {
  out_.reset();
  cancelled_ = writing_.has_value();
}

void Mailbox::listen(bool yes, TimePoint now) {
  if (std::exchange(listening_, yes) == yes) return;
  waiting_since_ = now;
  look_about(now);
}

/// Something has changed. What is in SM1 is read before anything else.
void Mailbox::look_about(TimePoint now) {
  const bool about_to_read = asking_ && state_ == State::read;
  if (!under_way_ && !about_to_read) proceed(now);
}

void Mailbox::go(State state, TimePoint now, Duration pause) {
  state_ = state;
  asking_ = pause == Duration{};
  deadline_ = asking_ ? kNever : now + pause;
}

void Mailbox::on_time(TimePoint now) {
  if (under_way_ || asking_ || now < deadline_) return;
  go(State::look, now);
}

/// What is to be done next, when nothing is under way. Unless the last message was answered SM1 is looked at
/// before the next is written: what is in it then does not answer that.
void Mailbox::proceed(TimePoint now) {
  const bool settled = !draining_ && !in_doubt_ && recovery_ == Recovery::none;
  if (out_ && free_ && settled && answered_) return go(State::write, now);
  if (out_ || listening_ || !settled) return go(State::look, now);
  asking_ = false;
  state_ = State::idle;
  deadline_ = options_.idle_poll > Duration{} ? now + options_.idle_poll : kNever;
}

bool Mailbox::waited_for() const { return out_ || writing_ || listening_ || recovery_ != Recovery::none; }

/// Looks are the denser the shorter the wait has been: a slave that answers at once is not kept, one that
/// takes its time is not flooded.
void Mailbox::pause_and_look(TimePoint now) {
  if (!waited_for() && !draining_) return proceed(now);
  const auto waited = std::clamp<Duration>((now - waiting_since_) / 16, Duration{1}, kLongestPause);
  go(State::look, now, waited_for() ? waited : kUnanswered);
}

std::optional<Request> Mailbox::take_request() {
  if (!std::exchange(asking_, false)) return std::nullopt;
  // What was to be written may have been cancelled since.
  if (state_ == State::write && !out_) state_ = State::look;
  const auto& place = options_.place;
  under_way_ = true;
  switch (state_) {
    case State::idle:
    case State::look: break;
    case State::read: return read_once(slave_, place.in_start, place.in_size);
    case State::ask_repeat: return write_registers(slave_, reg::sm_activate(1), {activate_});
    case State::write:
      free_ = false;
      writing_ = std::exchange(out_, std::nullopt);
      cancelled_ = false;
      return write_once(slave_, place.out_start,
                        mailbox_bytes(MailboxType::coe, counter_, writing_->message, place.out_size));
  }
  return read_registers(slave_, kStatus, kStatusSize);
}

void Mailbox::on_answer(const Answer& answer, TimePoint now) {
  if (!std::exchange(under_way_, false)) return;
  switch (state_) {
    case State::write: return on_written(answer, now);
    case State::read: return on_read(answer, now);
    case State::ask_repeat: return pause_and_look(now);
    case State::idle:
    case State::look:
      if (!answer.done()) return on_missing(answer.lost, now);
      return on_looked(answer.data, now);
  }
}

/// Not a word from the slave: whoever waits has its own limit. What it did not count then it has not taken.
void Mailbox::on_missing(bool lost, TimePoint now) {
  if (!lost && std::exchange(uncounted_, false)) {
    in_doubt_ = false;
    if (!out_ && !cancelled_) out_ = std::move(writing_);
    writing_.reset();
  }
  if (out_ && now >= out_->until)
    give_up("it does not answer at all",
            "is it powered, and is the cable leading to it plugged in? `scan` shows which slaves answer");
  pause_and_look(now);
}

void Mailbox::on_looked(ByteSpan status, TimePoint now) {
  full_ = (status[0] & reg::kSmFull) != 0;
  free_ = !full_;
  if (in_doubt_) settle_doubt(now);
  if (recovery_ != Recovery::none && recover(status, now)) return;
  if ((status[kSm1Status] & reg::kSmFull) != 0) return go(State::read, now);
  draining_ = false;
  if (out_ && free_) return go(State::write, now);
  if (out_ && now >= out_->until)
    give_up("its mailbox stays full",
            "it no longer accepts messages: `state init` and up again, or power cycle it");
  pause_and_look(now);
}

/// SM0 was empty before. Full, the message is there; empty, it may have been taken by now, or never have
/// come. Either way it is not written again: the slave may do what it says.
void Mailbox::settle_doubt(TimePoint now) {
  in_doubt_ = false;
  uncounted_ = false;
  if (free_) ++statistics_.doubtful;
  count_sent(now);
}

void Mailbox::count_sent(TimePoint now) {
  ++statistics_.sent;
  answered_ = false;
  writing_.reset();
  counter_ = next_mailbox_counter(counter_);
  waiting_since_ = now;
}

/// The frame that read SM1 is lost. Full, it was not read, or holds the next message; empty, the last one is
/// asked for again. True when there is something to wait for.
bool Mailbox::recover(ByteSpan status, TimePoint now) {
  const bool full = (status[kSm1Status] & reg::kSmFull) != 0;
  if (recovery_ == Recovery::read_lost) {
    if (full) {
      recovery_ = Recovery::none;
      skipped_ = true;
      return false;
    }
    ++statistics_.repeated;
    recovery_ = Recovery::asked;
    recovery_until_ = now + options_.repeat_timeout;
    activate_ = status[kSm1Activate] ^ reg::kSmRepeat;
    go(State::ask_repeat, now);
    return true;
  }
  const bool done = ((status[kSm1Processor] ^ activate_) & reg::kSmRepeatDone) == 0;
  if (done && full) {
    recovery_ = Recovery::none;
    return false;
  }
  if (now < recovery_until_) {
    pause_and_look(now);
    return true;
  }
  recovery_ = Recovery::none;
  ++statistics_.missed;
  return false;
}

void Mailbox::on_written(const Answer& answer, TimePoint now) {
  if (answer.done()) {
    count_sent(now);
    return proceed(now);
  }
  in_doubt_ = true;
  uncounted_ = !answer.lost;
  go(State::look, now);
}

/// It was full: where nobody counts as having read it, it may be empty now all the same.
void Mailbox::on_read(const Answer& answer, TimePoint now) {
  if (!answer.done()) {
    recovery_ = Recovery::read_lost;
    return go(State::look, now);
  }
  take_in(answer.data);
  skipped_ = false;
  proceed(now);
}

void Mailbox::give_up(std::string what, std::string hint) {
  out_.reset();
  events_.push_back(Failure{Errc::timeout, std::move(what), std::move(hint)});
}

}  // namespace servoctl::ethercat
