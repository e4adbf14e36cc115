#include "can/serial_port.hpp"

// Any speed, which <termios.h> has no names for; the two headers exclude each other.
#include <asm/termbits.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <linux/tty.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::can {
namespace {

std::string serial_ports_text() {
  const auto ports = serial_adapters();
  if (ports.empty()) return "this machine has no USB serial port; the end of dmesg tells what the kernel saw";
  return formatted("USB serial ports: {}", fmt::join(ports, ", "));
}

tl::unexpected<Error> serial_in_use(const std::string& device) {
  return fail(Errc::bus, message("{} is in use by another program", as_it_is(device)),
              message("`fuser -v {}` shows which; another servoctl, slcand, a terminal program or "
                      "ModemManager",
                      as_it_is(device)));
}

tl::unexpected<Error> serial_not_opened(const std::string& device, int error) {
  if (error == EBUSY || error == EWOULDBLOCK) return serial_in_use(device);
  if (error == ENOENT)
    return fail(Errc::bus, message("there is no {}", as_it_is(device)),
                message("is the adapter plugged in? {}", serial_ports_text()));
  if (error == EACCES || error == EPERM)
    return fail(Errc::bus, message("{} may not be opened: {}", as_it_is(device), system_text(error)),
                "its group may, mostly dialout: `sudo usermod -aG dialout $USER`, then log in again");
  if (error == ENOTTY || error == EISDIR || error == EINVAL)
    return fail(Errc::bus, message("{} is no serial port", as_it_is(device)), serial_ports_text());
  if (error == ENXIO || error == EIO || error == ENODEV)
    return fail(Errc::bus, message("there is no adapter behind {}", as_it_is(device)), serial_ports_text());
  return fail(Errc::bus, message("cannot open {}: {}", as_it_is(device), system_text(error)),
              serial_ports_text());
}

unsigned character_flags(const SerialLine& line) {
  unsigned out = line.data_bits == 7 ? CS7 : CS8;
  if (line.parity != 'N') out |= PARENB;
  if (line.parity == 'O') out |= PARODD;
  if (line.stop_bits == 2) out |= CSTOPB;
  return out;
}

/// Bytes as they come, no flow control: the carrier of a modem is of no consequence.
termios2 raw_settings(const SerialLine& line) {
  termios2 out{};
  out.c_iflag = line.parity == 'N' ? 0 : INPCK;
  out.c_cflag = BOTHER | CREAD | CLOCAL | character_flags(line);
  out.c_ispeed = line.baud;
  out.c_ospeed = line.baud;
  out.c_cc[VMIN] = 1;  // So that a read of nothing is an error, and a read of zero bytes the end.
  return out;
}

Result<void> set_line(int port, const SerialLine& line) {
  const auto refused = [&](const Message& why) {
    return fail(Errc::bus, message("{} does not take {}: {}", as_it_is(line.device), line.text(), why),
                "use a speed that the port and what hangs at it both have");
  };
  const auto raw = raw_settings(line);
  if (::ioctl(port, TCSETS2, &raw) != 0) return refused(system_text(errno));
  termios2 now{};
  if (::ioctl(port, TCGETS2, &now) != 0) return refused(system_text(errno));
  // What a receiver of eleven bits bears.
  const auto off = now.c_ospeed > line.baud ? now.c_ospeed - line.baud : line.baud - now.c_ospeed;
  if (off * 50 > line.baud) return refused(message("it would run at {}", now.c_ospeed));
  return {};
}

/// Some USB bridges gather bytes for 16 ms otherwise.
void ask_for_low_latency(int port) {
  serial_struct settings{};
  if (::ioctl(port, TIOCGSERIAL, &settings) != 0) return;
  settings.flags |= int{ASYNC_LOW_LATENCY};
  (void)::ioctl(port, TIOCSSERIAL, &settings);
}

}  // namespace

std::string SerialLine::text() const { return formatted("{},{}{}{}", baud, data_bits, parity, stop_bits); }

std::optional<std::uint32_t> parse_baud(std::string_view text) {
  const auto baud = parse_digits(text, 10);
  if (!baud || *baud < 50 || *baud > 4'000'000) return std::nullopt;
  return static_cast<std::uint32_t>(*baud);
}

std::vector<std::string> serial_adapters() {
  std::vector<std::string> out;
  std::error_code error;
  using Folder = std::filesystem::directory_iterator;
  for (Folder at("/dev/serial/by-id", error), end; !error && at != end; at.increment(error))
    out.push_back(at->path().string());
  if (out.empty())
    for (Folder at("/dev", error), end; !error && at != end; at.increment(error)) {
      const auto name = at->path().filename().string();
      if (name.starts_with("ttyACM") || name.starts_with("ttyUSB")) out.push_back("/dev/" + name);
    }
  std::sort(out.begin(), out.end());
  return out;
}

SerialPort::SerialPort(Descriptor port, std::string device, const termios2& before)
    : port_(std::move(port)), device_(std::move(device)), before_(std::make_unique<termios2>(before)) {}

SerialPort::SerialPort(SerialPort&& other) noexcept = default;

SerialPort::~SerialPort() {
  if (!port_) return;
  // close() waits half a minute for bytes that a port which hangs does not take.
  if (waiting() > 0) ::ioctl(port_.get(), TCFLSH, TCOFLUSH);
  (void)::ioctl(port_.get(), TCSETS2, before_.get());
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

Result<SerialPort> SerialPort::open(const SerialLine& line) {
  const auto& device = line.device;
  Descriptor port(::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port) return serial_not_opened(device, errno);
  termios2 before{};
  if (::ioctl(port.get(), TCGETS2, &before) != 0) return serial_not_opened(device, errno);
  // A driver of the kernel (slcand, gpsd, ppp) sits on its port as a line discipline.
  int discipline = N_TTY;
  if (::ioctl(port.get(), TIOCGETD, &discipline) == 0 && discipline != N_TTY) return serial_in_use(device);
  // TIOCEXCL holds back ordinary users and other programs, the lock another servoctl of root.
  if (::flock(port.get(), LOCK_EX | LOCK_NB) != 0) return serial_not_opened(device, errno);
  if (::ioctl(port.get(), TIOCEXCL) != 0) return serial_not_opened(device, errno);
  // From here on it is put back.
  SerialPort out(std::move(port), device, before);
  if (const auto set = set_line(out.get(), line); !set) return fail(set.error());
  ask_for_low_latency(out.get());
  (void)::ioctl(out.get(), TCFLSH, TCIOFLUSH);
  return out;
}

tl::unexpected<Error> SerialPort::gone(int error) const {
  if (error == 0 || error == EIO || error == ENXIO || error == ENODEV)
    return fail(Errc::bus, message("{} is gone", as_it_is(device_)),
                "was the adapter unplugged? plug it in again");
  return fail(Errc::bus, message("{} failed: {}", as_it_is(device_), system_text(error)),
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
      return fail(Errc::bus, message("{} takes nothing any more", as_it_is(device_)),
                  "unplug the adapter and plug it in again");
    wait_for(port_.get(), POLLOUT, limit);
  }
  return {};
}

Result<void> SerialPort::read(std::string& out) {
  if (const auto taken = take_in(port_.get(), out); !taken.there) return gone(taken.error);
  return {};
}

}  // namespace servoctl::can
