#include "can/socketcan.hpp"

#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/format.hpp"
#include "base/signal_wait.hpp"
#include "base/timespec.hpp"
#include "can/socketcan_error.hpp"

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;

/// Between two looks at an interface that is down.
constexpr Duration kReopenPause = milliseconds(5);
/// Frames one call takes from the kernel, and one that waits for the first.
constexpr std::size_t kBatch = 64;
constexpr std::size_t kAwaited = 8;
/// Frames that wait here at most, some 24 MB; beyond that the kernel's queue has to do.
constexpr std::size_t kMostWaiting = 1U << 20U;

can_frame kernel_frame(const Frame& frame) {
  can_frame raw{};
  raw.can_id = frame.id;
  if (frame.extended) raw.can_id |= CAN_EFF_FLAG;
  if (frame.remote) raw.can_id |= CAN_RTR_FLAG;
  raw.can_dlc = frame.size;
  std::copy_n(frame.data.begin(), frame.payload().size(), raw.data);
  return raw;
}

Frame frame_of(const can_frame& raw) {
  Frame frame;
  frame.error = (raw.can_id & CAN_ERR_FLAG) != 0;
  frame.extended = !frame.error && (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = !frame.error && (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.id = raw.can_id & (frame.error || frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = std::min<std::uint8_t>(raw.can_dlc, CAN_MAX_DLEN);
  std::copy_n(raw.data, frame.payload().size(), frame.data.begin());
  return frame;
}

bool is_sendable(const Frame& frame) {
  return !frame.error && frame.size <= CAN_MAX_DLEN &&
         frame.id <= (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
}

Frame overflow_report() {
  Frame frame;
  frame.error = true;
  frame.id = CAN_ERR_CRTL;
  frame.size = CAN_ERR_DLC;
  frame.data[1] = CAN_ERR_CRTL_RX_OVERFLOW;
  return frame;
}

/// What the kernel says beside a message, in a control message of this type.
template <class T>
std::optional<T> told(const msghdr& message, int type) {
  auto copy = message;  // CMSG_NXTHDR takes no const.
  for (auto* control = CMSG_FIRSTHDR(&copy); control != nullptr; control = CMSG_NXTHDR(&copy, control)) {
    if (control->cmsg_level != SOL_SOCKET || control->cmsg_type != type) continue;
    T out{};
    std::memcpy(&out, CMSG_DATA(control), sizeof out);
    return out;
  }
  return std::nullopt;
}

/// The kernel stamps frames by the wall clock; taken with every batch, so that its steps do no harm.
class StampClock {
 public:
  StampClock() : now_(steady_now()), wall_(std::chrono::system_clock::now().time_since_epoch()) {}

  TimePoint time(const msghdr& message) const {
    const auto stamp = told<timespec>(message, SCM_TIMESTAMPNS);
    if (!stamp) return now_;
    const auto at = std::chrono::seconds(stamp->tv_sec) + std::chrono::nanoseconds(stamp->tv_nsec);
    const auto age = std::chrono::duration_cast<Duration>(wall_ - at);
    return age >= Duration::zero() && age < std::chrono::minutes(1) ? now_ - age : now_;
  }

 private:
  TimePoint now_;
  std::chrono::nanoseconds wall_;
};

/// The longest wait in one call of recvmmsg(): so late is a signal answered that came just before it.
constexpr Duration kSlice = std::chrono::milliseconds(20);

}  // namespace

SocketCanBus::SocketCanBus(Descriptor socket, std::string interface_name, Duration send_limit)
    : socket_(std::move(socket)), interface_name_(std::move(interface_name)), send_limit_(send_limit) {
  waits_in_slices_ = wait_in_slices(socket_.get(), kSlice);
}

Result<void> SocketCanBus::send(const Frame& frame) {
  if (!is_sendable(frame))
    return fail(Errc::bug,
                message("a frame that cannot be sent: {}, {} bytes", to_string(frame), frame.size));
  if (is_bus_off_) return interface_bus_off(interface_name_);
  const auto raw = kernel_frame(frame);
  std::optional<TimePoint> limit;  // The clock is asked only when the first try fails.
  for (;;) {
    if (::send(socket_.get(), &raw, sizeof raw, MSG_NOSIGNAL | MSG_DONTWAIT) >= 0) return {};
    const int error = errno;
    if (error == EINTR) continue;
    if (error != EAGAIN && error != ENOBUFS) return interface_lost(interface_name_, error);
    const auto tried = now();
    if (!limit) limit = tried + send_limit_;
    if (tried >= *limit) return interface_queue_full(interface_name_);
    // ENOBUFS is the queue of the interface; poll() looks at that of the socket only, and returns at once.
    if (error == ENOBUFS)
      nap(milliseconds(1));
    else
      wait_for(socket_.get(), POLLOUT, *limit);
  }
}

Result<std::optional<Frame>> SocketCanBus::receive(TimePoint deadline) {
  if (inbox_.empty() && delay_ > Duration::zero()) {
    const auto woken = wait_or_signal(-1, 0, std::min(deadline, now() + delay_));
    drain();  // Most likely there is something: no need to ask first.
    if (woken == Wake::interrupted && inbox_.empty() && !failed_) return std::optional<Frame>();
  }
  while (inbox_.empty()) {
    // The kernel tells it once; it stays so until recover().
    if (failed_) return fail(*failed_);
    if (const auto woken = wait_for_frames(deadline); woken != Wake::ready) return std::optional<Frame>();
  }
  if (inbox_.size() >= kBatch && given_ >= kBatch) drain();
  ++given_;
  const auto [frame, time] = inbox_.front();
  inbox_.pop_front();
  arrived_ = time;
  return std::optional(frame);
}

/// Ready: something was taken into the inbox, or failed. While the deadline is far the kernel waits with the
/// frames, in slices: one system call a frame instead of four. A signal that comes between the question for
/// it and the call ends the next slice, not this one; near the deadline poll() leaves no such gap.
Wake SocketCanBus::wait_for_frames(TimePoint deadline) {
  while (waits_in_slices_ && deadline > now() + kSlice) {
    if (signal_is_noted()) return Wake::interrupted;
    drain(Take::awaited);
    if (!inbox_.empty() || failed_) return Wake::ready;
  }
  const auto woken = wait_or_signal(socket_.get(), POLLIN, deadline);
  if (woken == Wake::ready) drain();
  return woken;
}

/// A socket of its own, whether the old one is still bound or not: it also tells whether the controller is on
/// the bus. It takes the place of the old one, on which others may poll.
Result<void> SocketCanBus::recover(TimePoint deadline) {
  for (;;) {
    auto opened = socketcan_socket(interface_name_);
    if (opened) {
      waits_in_slices_ = wait_in_slices(opened->get(), kSlice);
      if (::dup3(opened->get(), socket_.get(), O_CLOEXEC) < 0)
        return fail(Errc::bus,
                    message("cannot open {} again: {}", as_it_is(interface_name_), system_text(errno)));
      inbox_.clear();
      failed_.reset();
      is_bus_off_ = false;
      lost_frames_ = 0;
      return {};
    }
    if (now() >= deadline) return fail(opened.error());
    nap(std::min<Duration>(kReopenPause, deadline - now()));
  }
}

std::vector<Message> SocketCanBus::take_notices() {
  const auto count = fd_frames_ - std::exchange(told_fd_, fd_frames_);
  if (count == 0) return {};
  return {count == 1 ? message("{}: 1 CAN FD frame came; servoctl reads frames of classical CAN only",
                               as_it_is(interface_name_))
                     : message("{}: {} CAN FD frames came; servoctl reads frames of classical CAN only",
                               as_it_is(interface_name_), count)};
}

/// Whoever is slower than the bus finds its frames here: the kernel drops what its queue has no room for.
void SocketCanBus::drain(Take take) {
  given_ = 0;
  for (auto before = inbox_.size(); !failed_ && before < kMostWaiting; before = inbox_.size()) {
    if (const auto filled = fill(take); !filled) failed_ = filled.error();
    if (inbox_.size() < before + (take == Take::awaited ? kAwaited : kBatch)) return;
    take = Take::present;
  }
}

/// Takes what is there into the inbox, as many frames as one call gives.
Result<void> SocketCanBus::fill(Take which) {
  union Raw {
    can_frame classical;
    canfd_frame fd;
  };
  std::array<Raw, kBatch> raw;
  std::array<iovec, kBatch> parts;
  std::array<mmsghdr, kBatch> messages;
  struct Control {
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(std::uint32_t)) + CMSG_SPACE(sizeof(timespec))> bytes;
  };
  std::array<Control, kBatch> controls;
  const std::size_t most = which == Take::awaited ? kAwaited : kBatch;
  for (std::size_t i = 0; i < most; ++i) {
    parts[i] = {&raw[i], sizeof raw[i]};
    messages[i] = {};
    messages[i].msg_hdr.msg_iov = &parts[i];
    messages[i].msg_hdr.msg_iovlen = 1;
    messages[i].msg_hdr.msg_control = controls[i].bytes.data();
    messages[i].msg_hdr.msg_controllen = controls[i].bytes.size();
  }
  const int count = ::recvmmsg(socket_.get(), messages.data(), static_cast<unsigned>(most),
                               which == Take::awaited ? MSG_WAITFORONE : MSG_DONTWAIT, nullptr);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return {};
  if (count <= 0 || messages[0].msg_len == 0) {
    is_bus_off_ = false;
    return interface_lost(interface_name_, count < 0 ? errno : EPIPE);
  }
  const StampClock clock;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const auto& head = messages[i].msg_hdr;
    fd_frames_ += messages[i].msg_len == sizeof(canfd_frame);
    // How many frames the kernel has dropped so far, where it says so.
    if (messages[i].msg_len == sizeof(can_frame))
      take(raw[i].classical, told<std::uint32_t>(head, SO_RXQ_OVFL), clock.time(head));
  }
  return {};
}

/// A frame that was on its way when the controller left the bus may come behind the report of it: only with a
/// carrier does it show that the controller takes part again.
void SocketCanBus::note_bus_off(const Frame& frame) {
  if (!frame.error) {
    is_bus_off_ = is_bus_off_ && socketcan_carrier(interface_name_) != true;
    return;
  }
  is_bus_off_ = (is_bus_off_ || (frame.id & CAN_ERR_BUSOFF) != 0) && (frame.id & CAN_ERR_RESTARTED) == 0;
}

void SocketCanBus::take(const can_frame& raw, std::optional<std::uint32_t> lost_in_all, TimePoint time) {
  const auto frame = frame_of(raw);
  note_bus_off(frame);
  if (lost_in_all && std::exchange(lost_frames_, *lost_in_all) != *lost_in_all)
    inbox_.push_back({overflow_report(), time});
  inbox_.push_back({frame, time});
}

}  // namespace servoctl::can
