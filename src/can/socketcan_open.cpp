// From the name of an interface to a socket that is bound to it.
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "can/socketcan.hpp"
#include "can/socketcan_error.hpp"

namespace servoctl::can {
namespace {

constexpr const char* kNetwork = "/sys/class/net";

/// What the kernel says in a file of one line; empty where it does not.
std::optional<std::uint64_t> number_in(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMostBytes = 64;
  const auto text = read_file(file, kMostBytes);
  return text ? parse_digits(trim(*text), 10) : std::nullopt;
}

/// Finds the interface and makes sure that it can be used.
Result<int> interface_index(int fd, const std::string& name) {
  ifreq request{};
  std::copy(name.begin(), name.end(), request.ifr_name);
  if (::ioctl(fd, SIOCGIFINDEX, &request) != 0) {
    if (errno != ENODEV) return interface_cannot_open(name, errno);
    return interface_missing(name);
  }
  const int index = request.ifr_ifindex;
  if (::ioctl(fd, SIOCGIFHWADDR, &request) != 0) return interface_cannot_open(name, errno);
  if (request.ifr_hwaddr.sa_family != ARPHRD_CAN) return interface_is_no_can(name);
  if (::ioctl(fd, SIOCGIFFLAGS, &request) != 0) return interface_cannot_open(name, errno);
  if ((request.ifr_flags & IFF_UP) == 0) return interface_down(name);
  if (socketcan_carrier(name) == false) return interface_bus_off(name);
  return index;
}

template <class T>
bool set_option(int fd, int level, int option, const T& value) {
  return ::setsockopt(fd, level, option, &value, sizeof value) == 0;
}

bool configure(int fd) {
  // Of what is wrong on the wire, too, as far as the driver tells it: silence has a reason then.
  constexpr can_err_mask_t kReports = CAN_ERR_TX_TIMEOUT | CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED |
                                      CAN_ERR_PROT | CAN_ERR_ACK | CAN_ERR_TRX | CAN_ERR_BUSERROR;
  constexpr int kReceiveBytes = 4 << 20;
  // Beyond the limit for ordinary users where that is allowed; otherwise the kernel takes what it allows.
  if (!set_option(fd, SOL_SOCKET, SO_RCVBUFFORCE, kReceiveBytes))
    set_option(fd, SOL_SOCKET, SO_RCVBUF, kReceiveBytes);
  set_option(fd, SOL_SOCKET, SO_RXQ_OVFL, 1);
  set_option(fd, SOL_SOCKET, SO_TIMESTAMPNS, 1);
  // Counted only; a kernel without CAN FD lets none through.
  set_option(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, 1);
  return set_option(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, kReports);
}

}  // namespace

std::optional<bool> socketcan_carrier(const std::string& name) {
  const auto carrier = number_in(formatted("{}/{}/carrier", kNetwork, name));
  return carrier ? std::optional(*carrier != 0) : std::nullopt;
}

Result<Descriptor> socketcan_socket(const std::string& name) {
  if (name.empty() || name.size() >= IFNAMSIZ || name.find('/') != std::string::npos)
    return interface_no_name(name);
  Descriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (!socket && (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT))
    return fail(
        Errc::bus, message("cannot open {}: no SocketCAN in the kernel", as_it_is(name)),
        "load it with `sudo modprobe can-raw`, or use a bus that needs no kernel CAN: slcan:PORT@500k for an "
        "adapter that is a serial port, local:NAME between processes of this machine, or sim: for simulated "
        "drives");
  if (!socket) return interface_cannot_open(name, errno);
  const auto index = interface_index(socket.get(), name);
  if (!index) return fail(index.error());
  if (!configure(socket.get())) return interface_cannot_open(name, errno);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = *index;
  // The one way in which the socket interface takes addresses of all families.
  const auto* const generic = reinterpret_cast<const sockaddr*>(&address);
  if (::bind(socket.get(), generic, sizeof address) != 0) return interface_cannot_open(name, errno);
  return socket;
}

Result<std::unique_ptr<Bus>> open_socketcan(std::string_view interface_name) {
  const std::string name(interface_name);
  auto socket = socketcan_socket(name);
  if (!socket) return fail(socket.error());
  return std::make_unique<SocketCanBus>(std::move(*socket), name);
}

Result<std::unique_ptr<Bus>> open_socketcan_listener(const std::string& name) {
  auto socket = socketcan_socket(name);
  if (!socket) return fail(socket.error());
  constexpr can_err_mask_t kAll = CAN_ERR_MASK;
  if (!set_option(socket->get(), SOL_CAN_RAW, CAN_RAW_ERR_FILTER, kAll))
    return interface_cannot_open(name, errno);
  return std::make_unique<SocketCanBus>(std::move(*socket), name);
}

bool is_can_interface(const std::string& name) {
  return number_in(std::filesystem::path(kNetwork) / name / "type") == unsigned{ARPHRD_CAN};
}

std::vector<std::string> can_interfaces() {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(kNetwork, error), end; !error && entry != end;
       entry.increment(error)) {
    if (number_in(entry->path() / "type") == unsigned{ARPHRD_CAN}) names.push_back(entry->path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace servoctl::can
