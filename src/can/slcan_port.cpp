#include "can/slcan_port.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <linux/tty.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/number.hpp"
#include "base/text.hpp"
#include "can/slcan_codec.hpp"

namespace servoctl::can {
namespace {

struct BaudRate {
  std::uint32_t baud;
  speed_t code;
};
constexpr std::array<BaudRate, 13> kBaudRates{{{9'600, B9600},
                                               {19'200, B19200},
                                               {38'400, B38400},
                                               {57'600, B57600},
                                               {115'200, B115200},
                                               {230'400, B230400},
                                               {460'800, B460800},
                                               {500'000, B500000},
                                               {921'600, B921600},
                                               {1'000'000, B1000000},
                                               {2'000'000, B2000000},
                                               {3'000'000, B3000000},
                                               {4'000'000, B4000000}}};

std::optional<speed_t> baud_code(std::uint32_t baud) {
  const auto* const found = std::find_if(kBaudRates.begin(), kBaudRates.end(),
                                         [baud](const BaudRate& rate) { return rate.baud == baud; });
  return found == kBaudRates.end() ? std::nullopt : std::optional(found->code);
}

/// `500k`, `1M`, `125000`
std::optional<std::uint32_t> slcan_bitrate(std::string_view text) {
  std::uint64_t scale = 1;
  if (!text.empty() && (text.back() == 'k' || text.back() == 'K')) scale = 1'000;
  if (!text.empty() && (text.back() == 'M' || text.back() == 'm')) scale = 1'000'000;
  if (scale > 1) text.remove_suffix(1);
  const auto number = parse_digits(text, 10);
  if (!number || *number > 1'000'000) return std::nullopt;
  const auto out = *number * scale;
  if (out > 1'000'000 || !slcan_bitrate_digit(static_cast<std::uint32_t>(out))) return std::nullopt;
  return static_cast<std::uint32_t>(out);
}

tl::unexpected<Error> no_slcan_place(std::string_view text, std::string_view why) {
  return fail(Errc::usage, fmt::format("slcan:{}: {}", text, why),
              fmt::format("write slcan:/dev/ttyACM0@500k: the port, and a bitrate of {}; where the port is a "
                          "real serial line, its baud rate behind: slcan:/dev/ttyUSB0@500k,57600",
                          slcan_bitrates_text()));
}

/// Names that stay when adapters are plugged in another order go first.
std::string serial_ports_text() {
  std::vector<std::string> ports;
  std::error_code error;
  using Folder = std::filesystem::directory_iterator;
  for (Folder at("/dev/serial/by-id", error), end; !error && at != end; at.increment(error))
    ports.push_back(at->path().string());
  if (ports.empty())
    for (Folder at("/dev", error), end; !error && at != end; at.increment(error)) {
      const auto name = at->path().filename().string();
      if (name.starts_with("ttyACM") || name.starts_with("ttyUSB")) ports.push_back("/dev/" + name);
    }
  std::sort(ports.begin(), ports.end());
  if (ports.empty()) return "this machine has no USB serial port";
  return fmt::format("USB serial ports: {}", fmt::join(ports, ", "));
}

tl::unexpected<Error> serial_in_use(const std::string& device) {
  return fail(Errc::bus, fmt::format("{} is in use by another program", device),
              fmt::format("`fuser -v {}` shows which; another servoctl, slcand, a terminal program or "
                          "ModemManager",
                          device));
}

tl::unexpected<Error> serial_not_opened(const std::string& device, int error) {
  if (error == EBUSY || error == EWOULDBLOCK) return serial_in_use(device);
  if (error == ENOENT)
    return fail(Errc::bus, fmt::format("there is no {}", device),
                fmt::format("is the adapter plugged in? {}", serial_ports_text()));
  if (error == EACCES || error == EPERM)
    return fail(Errc::bus, fmt::format("{} may not be opened: {}", device, system_text(error)),
                "its group may, mostly dialout: `sudo usermod -aG dialout $USER`, then log in again");
  if (error == ENOTTY || error == EISDIR || error == EINVAL)
    return fail(Errc::bus, fmt::format("{} is no serial port", device), serial_ports_text());
  if (error == ENXIO || error == EIO || error == ENODEV)
    return fail(Errc::bus, fmt::format("there is no adapter behind {}", device), serial_ports_text());
  return fail(Errc::bus, fmt::format("cannot open {}: {}", device, system_text(error)), serial_ports_text());
}

/// Bytes as they come, eight bits, no flow control: the carrier of a modem is of no consequence.
termios raw_settings(termios settings, speed_t speed) {
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  settings.c_cc[VMIN] = 1;  // So that a read of nothing is an error, and a read of zero bytes the end.
  settings.c_cc[VTIME] = 0;
  ::cfsetispeed(&settings, speed);
  ::cfsetospeed(&settings, speed);
  return settings;
}

/// Some USB bridges gather bytes for 16 ms otherwise.
void ask_for_low_latency(int port) {
  serial_struct settings{};
  if (::ioctl(port, TIOCGSERIAL, &settings) != 0) return;
  settings.flags |= int{ASYNC_LOW_LATENCY};
  (void)::ioctl(port, TIOCSSERIAL, &settings);
}

}  // namespace

Result<SlcanPlace> parse_slcan_place(std::string_view text) {
  const auto at = text.rfind('@');
  if (at == std::string_view::npos) return no_slcan_place(text, "the bitrate of the bus is missing");
  if (at == 0) return no_slcan_place(text, "the port is missing");
  SlcanPlace out{.device = std::string(text.substr(0, at))};
  const auto rates = text.substr(at + 1);
  const auto comma = rates.find(',');
  const auto bitrate = slcan_bitrate(rates.substr(0, comma));
  if (!bitrate)
    return no_slcan_place(text,
                          fmt::format("'{}' is no bitrate that such an adapter has", rates.substr(0, comma)));
  out.bitrate = *bitrate;
  if (comma == std::string_view::npos) return out;
  const auto baud = parse_digits(rates.substr(comma + 1), 10);
  if (!baud || *baud > 4'000'000 || !baud_code(static_cast<std::uint32_t>(*baud)))
    return no_slcan_place(text,
                          fmt::format("'{}' is no baud rate of a serial port", rates.substr(comma + 1)));
  out.baud = static_cast<std::uint32_t>(*baud);
  return out;
}

SerialPort::SerialPort(Descriptor port, std::string device, const termios& before)
    : port_(std::move(port)), device_(std::move(device)), before_(before) {}

SerialPort::~SerialPort() {
  if (!port_) return;
  // close() waits half a minute for bytes that a port which hangs does not take.
  if (waiting() > 0) ::tcflush(port_.get(), TCOFLUSH);
  ::tcsetattr(port_.get(), TCSANOW, &before_);
  // Else the port stays closed to ordinary users while any other program still has it.
  (void)::ioctl(port_.get(), TIOCNXCL);
}

/// Bytes that were written and have not left.
int SerialPort::waiting() const {
  int out = 0;
  return ::ioctl(port_.get(), TIOCOUTQ, &out) == 0 ? out : 0;
}

void SerialPort::drain(TimePoint limit) const {
  while (waiting() > 0 && steady_now() < limit) nap(std::chrono::milliseconds(1));
}

Result<SerialPort> SerialPort::open(const std::string& device, std::uint32_t baud) {
  Descriptor port(::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port) return serial_not_opened(device, errno);
  termios before{};
  if (::tcgetattr(port.get(), &before) != 0) return serial_not_opened(device, errno);
  // The kernel's own driver for such adapters (slcand) sits on the port as a line discipline.
  int discipline = N_TTY;
  if (::ioctl(port.get(), TIOCGETD, &discipline) == 0 && discipline != N_TTY) return serial_in_use(device);
  // TIOCEXCL holds back ordinary users and other programs, the lock another servoctl of root.
  if (::flock(port.get(), LOCK_EX | LOCK_NB) != 0) return serial_not_opened(device, errno);
  if (::ioctl(port.get(), TIOCEXCL) != 0) return serial_not_opened(device, errno);
  const auto raw = raw_settings(before, baud_code(baud).value_or(B115200));
  if (::tcsetattr(port.get(), TCSANOW, &raw) != 0) return serial_not_opened(device, errno);
  ask_for_low_latency(port.get());
  ::tcflush(port.get(), TCIOFLUSH);
  return SerialPort(std::move(port), device, before);
}

tl::unexpected<Error> SerialPort::gone(int error) const {
  if (error == 0 || error == EIO || error == ENXIO || error == ENODEV)
    return fail(Errc::bus, fmt::format("{} is gone", device_), "was the adapter unplugged? plug it in again");
  return fail(Errc::bus, fmt::format("{} failed: {}", device_, system_text(error)),
              "was the adapter unplugged? plug it in again");
}

Result<void> SerialPort::write(std::string_view text, TimePoint limit) {
  while (!text.empty()) {
    const auto wrote = ::write(port_.get(), text.data(), text.size());
    if (wrote > 0) {
      text.remove_prefix(static_cast<std::size_t>(wrote));
      continue;
    }
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote < 0 && errno != EAGAIN) return gone(errno);
    if (steady_now() >= limit)
      return fail(Errc::bus, fmt::format("{} takes nothing any more", device_),
                  "unplug the adapter and plug it in again");
    wait_for(port_.get(), POLLOUT, limit);
  }
  return {};
}

Result<void> SerialPort::read(std::string& out) {
  std::array<char, 4096> bytes;
  for (;;) {
    const auto count = ::read(port_.get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) return {};
    if (count <= 0) return gone(count < 0 ? errno : 0);
    out.append(bytes.data(), static_cast<std::size_t>(count));
    if (static_cast<std::size_t>(count) < bytes.size()) return {};
  }
}

}  // namespace servoctl::can
