#include "can/slcan.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "base/format.hpp"
#include "base/signal_wait.hpp"

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;

/// A frame is offered for so long, and its answer waited for.
constexpr Duration kSlcanSendLimit = std::chrono::seconds(1);
/// The answer to it; then the adapter is asked whether it is there.
constexpr Duration kFrameAnswer = milliseconds(300);
/// Between two offers of a frame that was refused.
constexpr Duration kOfferPause = milliseconds(2);
/// Of firmware whose stamps are whole 16-bit numbers.
constexpr Duration kLongStampPeriod = milliseconds(65'536);
constexpr std::uint16_t kLastShortStamp = 0xEA5F;
/// Frames that wait here at most.
constexpr std::size_t kMostReceived = 1U << 20U;

bool is_of_the_protocol(const Frame& frame) {
  return !frame.error && frame.size <= 8 && frame.id <= (frame.extended ? 0x1FFF'FFFFU : 0x7FFU);
}

}  // namespace

tl::unexpected<Error> SlcanBus::lose(Error error) {
  opening_.reset();
  port_.reset();  // A port that is held keeps its number: the adapter would come back under another.
  lost_ = error;
  return fail(std::move(error));
}

tl::unexpected<Error> SlcanBus::not_open() const {
  return fail(lost_.value_or(make_error(Errc::bug, "an adapter that is not open")));
}

Result<void> SlcanBus::write(std::string_view text, TimePoint limit) {
  if (!port_) return not_open();
  if (auto sent = port_->write(text, limit); !sent) return lose(sent.error());
  return {};
}

Result<void> SlcanBus::send(const Frame& frame) {
  if (!is_of_the_protocol(frame))
    return fail(Errc::bug,
                message("a frame that cannot be sent: {}, {} bytes", to_string(frame), frame.size));
  if (!is_open()) return not_open();
  const auto line = slcan_line(frame);
  const auto limit = now() + kSlcanSendLimit;
  await_watch();
  for (;;) {
    answer_ = Answer::none;
    version_came_ = false;
    if (const auto sent = write(line, limit); !sent) return sent;
    if (!acknowledges_ || !acknowledges_frames_) return {};
    const auto answer = answer_to_frame(limit);
    if (!answer) return fail(answer.error());
    if (*answer != Answer::refused) return {};
    if (now() >= limit)
      return fail(Errc::bus,
                  message("the adapter at {} refuses frames: its transmit queue remains full",
                          as_it_is(place_.device)),
                  "is another node on the bus, and is the bitrate right?");
    nap(kOfferPause);
  }
}

/// A frame that is not acknowledged: the adapter is asked for its version. It answers in order: when the
/// version is there and the acknowledge is not, that was lost, or its firmware has none for frames. What
/// became of the frame is for whoever waits for an answer to it.
Result<SlcanBus::Answer> SlcanBus::answer_to_frame(TimePoint limit) {
  auto answer = wait_for_answer(now() + kFrameAnswer);
  if (!answer || *answer != Answer::none) {
    frame_was_acknowledged_ = frame_was_acknowledged_ || (answer && *answer == Answer::acknowledged);
    return answer;
  }
  if (!version_.empty()) {
    version_came_ = false;
    if (const auto asked = write("V\r", limit); !asked) return fail(asked.error());
    // An acknowledge that comes meanwhile is late, not lost; the version is waited for all the same, or it
    // would be taken for the answer to the next frame's question.
    answer = wait_for_version(limit);
    if (!answer || *answer != Answer::none) return answer;
  }
  if (!version_came_ && (frame_was_acknowledged_ || !version_.empty()))
    return lose(make_error(Errc::bus,
                           message("the adapter at {} does not answer any more", as_it_is(place_.device)),
                           "unplug it and plug it in again"));
  if (frame_was_acknowledged_)
    ++unanswered_;
  else
    acknowledges_frames_ = false;
  return Answer::none;
}

/// An answer to what it is asked regularly would be taken for that to the frame.
void SlcanBus::await_watch() {
  const auto limit = watch_.awaited();
  if (!limit) return;
  while (port_ && watch_.awaited() && now() < *limit)
    if (wait_for(port_->get(), POLLIN, *limit) == Wake::ready && !fill()) return;
  if (watch_.awaited()) watch_.give_up();
}

Result<SlcanBus::Answer> SlcanBus::wait_for_answer(TimePoint limit) {
  return wait_while([&] { return answer_ == Answer::none && !version_came_; }, limit);
}

Result<SlcanBus::Answer> SlcanBus::wait_for_version(TimePoint limit) {
  return wait_while([&] { return !version_came_; }, limit);
}

Result<SlcanBus::Answer> SlcanBus::wait_while(const std::function<bool()>& missing, TimePoint limit) {
  is_offering_ = true;
  Result<void> filled;
  while (filled && missing() && now() < limit)
    if (wait_for(port_->get(), POLLIN, limit) == Wake::ready) filled = fill();
  is_offering_ = false;
  if (!filled) return fail(filled.error());
  return answer_;
}

Result<void> SlcanBus::fill() {
  std::string bytes;
  const auto got = port_->read(bytes);
  const auto time = now();
  if (!bytes.empty()) watch_.on_bytes(time);
  reader_.put(bytes);
  while (const auto line = reader_.take()) on_line(*line, time);
  if (!got) return lose(got.error());
  if (watch_.state() == SlcanWatch::State::restarted)
    return lose(make_error(
        Errc::bus, message("the adapter at {} has started anew, and is closed", as_it_is(place_.device)),
        "is its plug loose, or its supply too weak? It is opened again by the next command"));
  return {};
}

void SlcanBus::on_line(const SlcanLine& line, TimePoint time) {
  const auto take = [&](const Frame& frame, TimePoint at) {
    if (inbox_.size() < kMostReceived) inbox_.push_back({frame, at});
  };
  switch (line.kind) {
    case SlcanLine::Kind::acknowledged:
    case SlcanLine::Kind::refused:
      return on_answer(line.kind == SlcanLine::Kind::refused ? Answer::refused : Answer::acknowledged,
                       !line.text.empty());
    case SlcanLine::Kind::flags:
      if (watch_.on_flags(time))
        for (const auto& report : slcan_reports(line.flags)) take(report, time);
      return;
    case SlcanLine::Kind::frame: return take(line.frame, line.stamp ? stamped(*line.stamp, time) : time);
    case SlcanLine::Kind::report: return take(line.frame, time);
    case SlcanLine::Kind::damaged: ++damaged_; return;
    case SlcanLine::Kind::text:
      if (line.text != version_) return;
      version_came_ = true;
      return watch_.on_version();
  }
}

/// To F from an adapter that does not know it; or to the frame, which alone is acknowledged by a letter.
void SlcanBus::on_answer(Answer answer, bool has_letter) {
  if (!has_letter && watch_.on_answer(now())) return;
  answer_ = answer;
  if (answer == Answer::refused && !is_offering_) ++refused_late_;
  if (acknowledges_frames_ || answer != Answer::acknowledged) return;
  // It does acknowledge frames: what was missed was lost.
  acknowledges_frames_ = true;
  frame_was_acknowledged_ = true;
  ++unanswered_;
}

TimePoint SlcanBus::stamped(std::uint16_t stamp, TimePoint time) {
  if (stamp > kLastShortStamp && !std::exchange(long_stamps_, true)) stamps_ = ForeignClock(kLongStampPeriod);
  return stamps_.time(milliseconds(stamp), time);
}

Result<void> SlcanBus::ask_again() {
  const auto question = watch_.take_question(now());
  if (watch_.state() == SlcanWatch::State::silent)
    return lose(make_error(Errc::bus,
                           message("the adapter at {} does not answer any more", as_it_is(place_.device)),
                           "unplug it and plug it in again"));
  return question.empty() ? Result<void>() : write(question, now() + SlcanWatch::kPatience);
}

Result<std::optional<Frame>> SlcanBus::receive(TimePoint deadline) {
  for (;;) {
    if (!inbox_.empty()) {
      const auto [frame, time] = inbox_.front();
      inbox_.pop_front();
      arrived_ = time;
      return std::optional(frame);
    }
    if (!is_open()) return not_open();
    if (now() >= watch_.due())
      if (const auto asked = ask_again(); !asked) return fail(asked.error());
    const auto woken = wait_or_signal(port_->get(), POLLIN, std::min(deadline, watch_.due()));
    if (woken == Wake::interrupted) return std::optional<Frame>();
    if (woken == Wake::elapsed) {
      if (now() >= deadline) return std::optional<Frame>();
      continue;
    }
    // What came before the loss is given first.
    if (const auto filled = fill(); !filled && inbox_.empty()) return fail(filled.error());
    if (inbox_.empty() && now() >= deadline) return std::optional<Frame>();
  }
}

std::vector<Message> SlcanBus::take_notices() {
  std::vector<Message> out;
  if (const auto count = std::exchange(damaged_, 0); count > 0)
    out.push_back(message(
        "{}: {} damaged line{} left out: bytes were lost between adapter and computer, and frames with them",
        as_it_is(place_.device), count, ending(count, " was", "s were")));
  if (const auto count = std::exchange(unanswered_, 0); count > 0)
    out.push_back(message("{}: {} frame{} not acknowledged by the adapter: whether {} sent is not known",
                          as_it_is(place_.device), count, ending(count, " was", "s were"),
                          count == 1 ? "it was" : "they were"));
  if (const auto count = std::exchange(refused_late_, 0); count > 0)
    out.push_back(message("{}: the adapter refused {} frame{} after a while: {} not sent",
                          as_it_is(place_.device), count, plural(count),
                          count == 1 ? "it was" : "they were"));
  return out;
}

TimePoint SlcanBus::next_event() const {
  if (!inbox_.empty()) return TimePoint::min();
  return is_open() ? watch_.due() : kNever;
}

}  // namespace servoctl::can
