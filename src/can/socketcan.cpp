#include "can/socketcan.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;

constexpr const char* kNetwork = "/sys/class/net";

can_frame encode(const Frame& frame) {
  can_frame raw{};
  raw.can_id = frame.id;
  if (frame.extended) raw.can_id |= CAN_EFF_FLAG;
  if (frame.remote) raw.can_id |= CAN_RTR_FLAG;
  raw.can_dlc = frame.size;
  std::copy_n(frame.data.begin(), frame.payload().size(), raw.data);
  return raw;
}

Frame decode(const can_frame& raw) {
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

/// How many frames the kernel has dropped so far, where it says so (SO_RXQ_OVFL).
std::optional<std::uint32_t> dropped(const msghdr& message) {
  const cmsghdr* control = CMSG_FIRSTHDR(&message);
  if (control == nullptr || control->cmsg_level != SOL_SOCKET || control->cmsg_type != SO_RXQ_OVFL) return {};
  std::uint32_t count = 0;
  std::memcpy(&count, CMSG_DATA(control), sizeof count);
  return count;
}

bool needs_no_bitrate(std::string_view name) {
  return name.starts_with("vcan") || name.starts_with("vxcan") || name.starts_with("slcan");
}

/// The command that brings the interface up.
std::string up_command(const std::string& name) {
  if (needs_no_bitrate(name)) return fmt::format("`sudo ip link set {} up`", name);
  return fmt::format("`sudo ip link set {} up type can bitrate 500000`, with the bitrate of the drives",
                     name);
}

std::string missing_hint() {
  const auto present = can_interfaces();
  const auto here = present.empty() ? std::string("no CAN interface is here")
                                    : fmt::format("CAN interfaces here: {}", fmt::join(present, ", "));
  return here +
         "; for a USB adapter: plug it in, then `sudo ip link set can0 up type can bitrate 500000`, with the "
         "bitrate "
         "of the drives; for a virtual bus: `sudo ip link add dev vcan0 type vcan && sudo ip link set vcan0 "
         "up`";
}

tl::unexpected<Error> bus_off(const std::string& name) {
  return fail(
      Errc::bus, fmt::format("{} is off the bus after too many errors (bus-off)", name),
      fmt::format(
          "check the bitrate, the cable and the two 120 ohm resistors; then `sudo ip link set {0} type "
          "can restart`, or take it down and up again: `sudo ip link set {0} down && sudo ip link "
          "set {0} up`",
          name));
}

/// A controller that is bus-off has no carrier; what is sent then is dropped without an error.
bool has_carrier(const std::string& name) {
  int carrier = 1;
  std::ifstream file(fmt::format("{}/{}/carrier", kNetwork, name));
  return !(file >> carrier) || carrier != 0;
}

tl::unexpected<Error> cannot_open(const std::string& name, int error) {
  return fail(Errc::bus, fmt::format("cannot open {}: {}", name, system_text(error)),
              fmt::format("`ip -details link show {}` tells its state", name));
}

/// Finds the interface and makes sure that it can be used.
Result<int> interface_index(int fd, const std::string& name) {
  ifreq request{};
  std::copy(name.begin(), name.end(), request.ifr_name);
  if (::ioctl(fd, SIOCGIFINDEX, &request) != 0) {
    if (errno != ENODEV) return cannot_open(name, errno);
    return fail(Errc::bus, fmt::format("there is no interface {}", name), missing_hint());
  }
  const int index = request.ifr_ifindex;
  if (::ioctl(fd, SIOCGIFHWADDR, &request) != 0) return cannot_open(name, errno);
  if (request.ifr_hwaddr.sa_family != ARPHRD_CAN)
    return fail(Errc::bus, fmt::format("{} is not a CAN interface", name), missing_hint());
  if (::ioctl(fd, SIOCGIFFLAGS, &request) != 0) return cannot_open(name, errno);
  if ((request.ifr_flags & IFF_UP) == 0)
    return fail(Errc::bus, fmt::format("{} is down", name), fmt::format("bring it up: {}", up_command(name)));
  if (!has_carrier(name)) return bus_off(name);
  return index;
}

template <class T>
bool set_option(int fd, int level, int option, const T& value) {
  return ::setsockopt(fd, level, option, &value, sizeof value) == 0;
}

/// Frames with a 29-bit identifier never pass: CANopen has none, and they would match an 11-bit mask.
bool set_filters(int fd, std::span<const Filter> filters) {
  std::vector<can_filter> raw;
  if (filters.size() <= CAN_RAW_FILTER_MAX)
    for (const auto& filter : filters)
      raw.push_back({filter.id & CAN_SFF_MASK, (filter.mask & CAN_SFF_MASK) | CAN_EFF_FLAG});
  if (raw.empty()) raw.push_back({0, CAN_EFF_FLAG});
  const auto size = static_cast<socklen_t>(raw.size() * sizeof raw.front());
  return ::setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, raw.data(), size) == 0;
}

bool configure(int fd, std::span<const Filter> filters) {
  constexpr can_err_mask_t kReports = CAN_ERR_TX_TIMEOUT | CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;
  constexpr int kReceiveBytes = 4 << 20;
  // Beyond the limit for ordinary users where that is allowed; otherwise the kernel takes what it allows.
  if (!set_option(fd, SOL_SOCKET, SO_RCVBUFFORCE, kReceiveBytes))
    set_option(fd, SOL_SOCKET, SO_RCVBUF, kReceiveBytes);
  set_option(fd, SOL_SOCKET, SO_RXQ_OVFL, 1);
  return set_option(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, kReports) && set_filters(fd, filters);
}

}  // namespace

SocketCanBus::SocketCanBus(Descriptor socket, std::string interface_name, Duration send_limit)
    : socket_(std::move(socket)), interface_name_(std::move(interface_name)), send_limit_(send_limit) {}

Result<void> SocketCanBus::send(const Frame& frame) {
  if (!is_sendable(frame))
    return fail(Errc::bug,
                fmt::format("a frame that cannot be sent: {}, {} bytes", to_string(frame), frame.size));
  if (is_bus_off_) return bus_off(interface_name_);
  const auto raw = encode(frame);
  const auto limit = now() + send_limit_;
  for (;;) {
    if (::send(socket_.get(), &raw, sizeof raw, MSG_NOSIGNAL) >= 0) return {};
    const int error = errno;
    if (error == EINTR) continue;
    if (error != EAGAIN && error != ENOBUFS) return lost(error);
    if (now() >= limit) return queue_full();
    // ENOBUFS is the queue of the interface; poll() looks at that of the socket only, and returns at once.
    if (error == ENOBUFS)
      nap(milliseconds(1));
    else
      wait_for(socket_.get(), POLLOUT, limit);
  }
}

Result<std::optional<Frame>> SocketCanBus::receive(TimePoint deadline) {
  if (held_back_) return std::exchange(held_back_, std::nullopt);
  for (;;) {
    auto frame = take();
    if (!frame || *frame || now() >= deadline) return frame;
    if (wait_for(socket_.get(), POLLIN, deadline) == Wake::interrupted) return frame;
  }
}

/// What is there without waiting.
Result<std::optional<Frame>> SocketCanBus::take() {
  for (;;) {
    can_frame raw{};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(std::uint32_t))];
    iovec part{&raw, sizeof raw};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    const auto size = ::recvmsg(socket_.get(), &message, 0);
    if (size < 0 && errno == EAGAIN) return std::optional<Frame>();
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) is_bus_off_ = false;
    if (size <= 0) return lost(size < 0 ? errno : EPIPE);
    if (static_cast<std::size_t>(size) != sizeof raw) continue;
    const auto frame = decode(raw);
    // A frame of the bus, or the report of a restart, shows that the controller takes part again.
    is_bus_off_ = frame.error && (is_bus_off_ || (frame.id & CAN_ERR_BUSOFF) != 0) &&
                  (frame.id & CAN_ERR_RESTARTED) == 0;
    if (!lost_some(dropped(message))) return frame;
    held_back_ = frame;
    return overflow_report();
  }
}

bool SocketCanBus::lost_some(std::optional<std::uint32_t> total) {
  if (!total || *total == lost_frames_) return false;
  lost_frames_ = *total;
  return true;
}

tl::unexpected<Error> SocketCanBus::lost(int error) const {
  const auto up = up_command(interface_name_);
  if (error == ENETDOWN)
    return fail(Errc::bus, fmt::format("{} went down", interface_name_),
                fmt::format("bring it up again: {}", up));
  if (error == ENXIO || error == ENODEV)
    return fail(Errc::bus, fmt::format("{} went down: the interface is gone", interface_name_),
                fmt::format("was the adapter unplugged? plug it in, then {}", up));
  return fail(Errc::bus, fmt::format("{} failed: {}", interface_name_, system_text(error)),
              fmt::format("`ip -details -statistics link show {}` tells its state", interface_name_));
}

tl::unexpected<Error> SocketCanBus::queue_full() const {
  return fail(Errc::bus, fmt::format("the transmit queue of {} stays full", interface_name_),
              fmt::format("is another node on the bus and the bitrate right? "
                          "`ip -details -statistics link show {0}`, `sudo ip link set {0} txqueuelen 1000`",
                          interface_name_));
}

Result<std::unique_ptr<Bus>> open_socketcan(std::string_view interface_name,
                                            std::span<const Filter> filters) {
  const std::string name(interface_name);
  if (name.empty() || name.size() >= IFNAMSIZ || name.find('/') != std::string::npos)
    return fail(Errc::usage, fmt::format("'{}' cannot be the name of an interface", name),
                "an interface has 1 to 15 characters, such as can0; `ip link` lists them");
  Descriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (!socket && (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT))
    return fail(
        Errc::bus, fmt::format("cannot open {}: the kernel has no CAN (SocketCAN)", name),
        "load it with `sudo modprobe can-raw`, or use a bus that needs no kernel CAN: local:NAME between "
        "processes of this machine, sim: for simulated drives");
  if (!socket) return cannot_open(name, errno);
  const auto index = interface_index(socket.get(), name);
  if (!index) return fail(index.error());
  if (!configure(socket.get(), filters)) return cannot_open(name, errno);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = *index;
  // The one way in which the socket interface takes addresses of all families.
  const auto* const generic = reinterpret_cast<const sockaddr*>(&address);
  if (::bind(socket.get(), generic, sizeof address) != 0) return cannot_open(name, errno);
  return std::make_unique<SocketCanBus>(std::move(socket), name);
}

std::vector<std::string> can_interfaces() {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(kNetwork, error), end; !error && entry != end;
       entry.increment(error)) {
    int type = 0;
    std::ifstream(entry->path() / "type") >> type;
    if (type == ARPHRD_CAN) names.push_back(entry->path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace servoctl::can
