// How the bus behind an adapter is opened, closed and opened again.
#include <poll.h>

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/signal_wait.hpp"
#include "can/slcan.hpp"

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;

/// For one command.
constexpr Duration kCommandLimit = std::chrono::seconds(1);
/// For the last word.
constexpr Duration kClosePatience = milliseconds(200);
/// Between two tries to open a port that is gone.
constexpr Duration kPortPause = milliseconds(20);

}  // namespace

SlcanBus::~SlcanBus() { close(); }

/// An adapter that stays open goes on acknowledging the frames of others, and floods its next program.
void SlcanBus::close() {
  opening_.reset();
  if (!port_) return;
  const auto limit = now() + kClosePatience;
  answer_ = Answer::none;
  watch_ = SlcanWatch();
  version_came_ = false;
  if (port_->write("C\r", limit) && acknowledges_)
    while (answer_ == Answer::none && wait_for(port_->get(), POLLIN, limit) == Wake::ready && fill()) {
    }
  if (port_) port_->drain(limit);
  port_.reset();
}

/// The port is there, and the first word may be sent.
Result<void> SlcanBus::begin() {
  auto port = SerialPort::open({.device = place_.device, .baud = place_.baud});
  if (!port) return fail(port.error());
  port_.emplace(std::move(*port));
  reader_.reset();
  stamps_ = ForeignClock(kStampPeriod);
  long_stamps_ = false;
  inbox_.clear();
  watch_ = SlcanWatch();
  acknowledges_frames_ = true;
  frame_was_acknowledged_ = false;
  opening_.emplace(slcan_bitrate_digit(place_.bitrate).value_or('6'), mode_, now());
  return {};
}

Result<void> SlcanBus::open(TimePoint limit, bool ends_by_signal) {
  if (auto begun = begin(); !begun) return begun;
  auto done = hand_shake(limit, ends_by_signal);
  if (!done) close();
  return done;
}

/// Errors leave the port as it is: where the opening is not done it can go on.
Result<void> SlcanBus::hand_shake(TimePoint limit, bool ends_by_signal) {
  if (auto done = talk(limit, ends_by_signal); !done) {
    lost_ = done.error();
    return done;
  }
  opening_.reset();
  lost_.reset();
  watch_ = SlcanWatch(acknowledges_, !version_.empty(), now());
  return {};
}

Result<void> SlcanBus::talk(TimePoint limit, bool ends_by_signal) {
  auto& opening = *opening_;
  while (!opening.is_done()) {
    if (const auto sent = write(opening.take_text(), now() + kCommandLimit); !sent) return sent;
    const auto end = std::min(opening.deadline(), limit);
    const auto woken =
        ends_by_signal ? wait_or_signal(port_->get(), POLLIN, end) : wait_for(port_->get(), POLLIN, end);
    if (woken == Wake::interrupted && ends_by_signal) return fail(Errc::interrupted, "interrupted");
    if (woken == Wake::ready) {
      std::string bytes;
      if (const auto got = port_->read(bytes); !got) return lose(got.error());
      reader_.put(bytes);
      while (const auto line = reader_.take()) {
        // Behind the last acknowledge stand the first frames.
        if (opening.is_done())
          on_line(*line, now());
        else
          opening.on_line(*line, now());
      }
    }
    opening.on_time(now());
    if (now() >= limit) break;
  }
  acknowledges_ = opening.acknowledges();
  version_ = opening.version();
  refuses_to_listen_ = opening.state() == SlcanOpening::State::refused_listening;
  return judge(opening);
}

Result<void> SlcanBus::judge(const SlcanOpening& opening) const {
  switch (opening.state()) {
    case SlcanOpening::State::open: return {};
    case SlcanOpening::State::refused_bitrate:
      return fail(
          Errc::usage,
          message("the adapter at {} refuses {} kbit/s", as_it_is(place_.device), place_.bitrate / 1000),
          "its manual lists the bitrates that it has");
    case SlcanOpening::State::refused_listening:
      return fail(
          Errc::usage,
          opening.acknowledges()
              ? message("the adapter at {} cannot listen without acknowledging", as_it_is(place_.device))
              : message("the adapter at {} answers to no command: whether it would only listen, "
                        "nobody knows",
                        as_it_is(place_.device)),
          "only listen-only leaves a bus undisturbed at a wrong bitrate: use another adapter, or ask "
          "what the bitrate is");
    case SlcanOpening::State::refused_opening:
      return fail(Errc::bus, message("the adapter at {} does not open its bus", as_it_is(place_.device)),
                  "unplug it and plug it in again");
    default: break;
  }
  return fail(
      Errc::bus,
      message("no adapter answers at {}{}", as_it_is(place_.device),
              opening.heard_something() ? ", though something talks there" : ""),
      "is it one with the LAWICEL protocol (slcan)? A real serial line needs the adapter's baud rate as well: "
      "slcan:/dev/ttyUSB0@500k,57600");
}

Result<void> SlcanBus::recover(TimePoint deadline) {
  if (!opening_) close();
  for (;;) {
    if (!opening_)
      if (auto begun = begin(); !begun) {
        if (now() >= deadline) return begun;
        nap(std::min<Duration>(kPortPause, deadline - now()));
        continue;
      }
    auto opened = hand_shake(deadline, false);
    // An adapter that starts anew, or answers late, has all rounds of the opening, as at first: the next call
    // goes on with them.
    if (opened || (opening_ && !opening_->is_done())) return opened;
    close();
    if (opened.error().code == Errc::usage || now() >= deadline) return opened;
    nap(std::min<Duration>(kPortPause, deadline - now()));
  }
}

Result<void> SlcanBus::leave_for(std::uint32_t bitrate) {
  if (!slcan_bitrate_digit(bitrate))
    return fail(Errc::usage, message("{} bit/s is no bitrate that such an adapter has", bitrate));
  close();
  place_.bitrate = bitrate;
  lost_ = make_error(Errc::bus, message("the adapter at {} was left", as_it_is(place_.device)));
  return {};
}

std::string SlcanBus::about() const {
  if (!port_) return {};
  const auto version = version_.empty() ? std::string("?") : version_;
  if (!acknowledges_ || !acknowledges_frames_)
    return formatted(
        "version {}; it acknowledges no frame, so that nobody knows which were sent, and tells nothing of its controller",
        version);
  if (watch_.has_flags())
    return formatted("version {}; its flags tell lost frames, warning, error-passive and errors on the wire",
                     version);
  return formatted("version {}; it acknowledges frames, and tells nothing of its controller", version);
}

Result<std::unique_ptr<Bus>> open_slcan(std::string_view place, SlcanOpening::Mode mode) {
  auto parsed = parse_slcan_place(place);
  if (!parsed) return fail(parsed.error());
  auto bus = std::make_unique<SlcanBus>(std::move(*parsed), mode);
  if (const auto opened = bus->open(kNever, true); !opened) return fail(opened.error());
  return bus;
}

}  // namespace servoctl::can
