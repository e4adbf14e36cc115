#include "modbus/serial_port.hpp"

// Any speed, which <termios.h> has no names for; the two headers exclude each other.
#include <asm/termbits.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>

#include "base/text.hpp"

namespace servoctl::modbus {
namespace {

using can::Descriptor;
using can::Wake;
using std::chrono::milliseconds;

/// How long send() tries while the queue of the port is full.
constexpr Duration kSendPatience = std::chrono::seconds(1);
constexpr Duration kReopenPause = milliseconds(20);

tl::unexpected<Error> cannot_open(const std::string& device, int error) {
  const auto what = fmt::format("cannot open {}: ", device);
  switch (error) {
    case ENOENT: {
      const auto there = serial_adapters();
      return fail(Errc::bus, what + "there is no such port",
                  there.empty() ? "no adapter is plugged in: `dmesg | tail` shows what the kernel saw"
                                : "adapters that are there: " + one_of(there));
    }
    case EACCES:
    case EPERM:
      return fail(Errc::bus, what + "you have no right to it",
                  "`ls -l` shows its group, on Debian dialout: `sudo usermod -aG dialout $USER`, then log in "
                  "again");
    case EBUSY:
      return fail(Errc::bus, what + "another program uses it", fmt::format("`fuser {}` shows which", device));
    default: return fail(Errc::bus, what + can::system_text(error));
  }
}

unsigned character_flags(const SerialSettings& settings) {
  unsigned out = settings.data_bits == 7 ? CS7 : CS8;
  if (settings.parity != 'N') out |= PARENB;
  if (settings.parity == 'O') out |= PARODD;
  if (settings.stop_bits == 2) out |= CSTOPB;
  return out;
}

/// Bytes as they are, at once, with the speed and form of the settings.
Result<void> set_line(int fd, const SerialSettings& settings) {
  termios2 line{};
  if (::ioctl(fd, TCGETS2, &line) != 0)
    return fail(Errc::bus, fmt::format("{} is no serial port", settings.device));
  line.c_iflag = settings.parity == 'N' ? 0 : INPCK;
  line.c_oflag = 0;
  line.c_lflag = 0;
  line.c_cflag = BOTHER | CREAD | CLOCAL | character_flags(settings);
  line.c_ispeed = settings.baud;
  line.c_ospeed = settings.baud;
  line.c_cc[VMIN] = 1;  // With 0 a line without bytes reads like one that is gone.
  line.c_cc[VTIME] = 0;
  const auto refused = [&](std::string_view why) {
    return fail(Errc::bus, fmt::format("{} does not take {}: {}", settings.device, settings.text(), why),
                "use a speed that adapter and drive both have");
  };
  if (::ioctl(fd, TCSETS2, &line) != 0) return refused(can::system_text(errno));
  termios2 now{};
  if (::ioctl(fd, TCGETS2, &now) != 0) return refused(can::system_text(errno));
  // What a receiver of eleven bits bears.
  const auto off = now.c_ospeed > settings.baud ? now.c_ospeed - settings.baud : settings.baud - now.c_ospeed;
  if (off * 50 > settings.baud) return refused(fmt::format("it would run at {}", now.c_ospeed));
  return {};
}

Result<Descriptor> open_device(const SerialSettings& settings) {
  Descriptor fd(::open(settings.device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!fd) return cannot_open(settings.device, errno);
  if (::flock(fd.get(), LOCK_EX | LOCK_NB) != 0) return cannot_open(settings.device, EBUSY);
  if (const auto set = set_line(fd.get(), settings); !set) return fail(set.error());
  ::ioctl(fd.get(), TCFLSH, TCIOFLUSH);
  return fd;
}

}  // namespace

Duration SerialPort::silence() const {
  if (settings_.framing != Framing::rtu) return Duration::zero();
  constexpr std::uint32_t kFixedAbove = 19200;
  if (settings_.baud > kFixedAbove) return Duration(1750);
  const auto characters = 35ULL * settings_.bits_per_character() * 1'000'000ULL / 10U;
  return Duration(static_cast<Duration::rep>(characters / settings_.baud));
}

tl::unexpected<Error> SerialPort::lost(int error) const {
  return fail(Errc::bus,
              fmt::format("{} is gone: {}", settings_.device,
                          error == 0 ? std::string("the other end was closed") : can::system_text(error)),
              "is the adapter still plugged in?");
}

Result<void> SerialPort::send(ByteSpan bytes) {
  const auto limit = now() + kSendPatience;
  while (!bytes.empty()) {
    const auto written = ::write(fd_.get(), bytes.data(), bytes.size());
    if (written > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(written));
      continue;
    }
    if (written < 0 && errno != EAGAIN && errno != EINTR) return lost(errno);
    if (now() >= limit)
      return fail(Errc::bus, fmt::format("{} takes no bytes", settings_.device), "is the adapter stuck?");
    (void)can::wait_for(fd_.get(), POLLOUT, limit);
  }
  return {};
}

Result<Bytes> SerialPort::receive(TimePoint deadline) {
  if (can::wait_or_signal(fd_.get(), POLLIN, deadline) != Wake::ready) return Bytes();
  std::array<std::uint8_t, 512> chunk{};
  const auto size = ::read(fd_.get(), chunk.data(), chunk.size());
  if (size > 0) return Bytes(chunk.begin(), chunk.begin() + size);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return Bytes();
  return lost(size < 0 ? errno : 0);
}

Result<void> SerialPort::reopen(TimePoint deadline) {
  fd_ = Descriptor();
  for (;;) {
    auto again = open_device(settings_);
    if (again) {
      fd_ = std::move(*again);
      return {};
    }
    if (now() >= deadline) return fail(again.error());
    if (can::wait_or_signal(-1, 0, std::min(deadline, now() + kReopenPause)) == Wake::interrupted)
      return fail(again.error());
  }
}

Result<std::unique_ptr<Port>> open_serial(const SerialSettings& settings) {
  auto fd = open_device(settings);
  if (!fd) return fail(fd.error());
  return std::make_unique<SerialPort>(std::move(*fd), settings);
}

std::vector<std::string> serial_adapters() {
  namespace fs = std::filesystem;
  std::vector<std::string> out;
  std::error_code error;
  for (auto at = fs::directory_iterator("/dev", error); at != fs::directory_iterator(); at.increment(error)) {
    const auto name = at->path().filename().string();
    if (name.starts_with("ttyUSB") || name.starts_with("ttyACM")) out.push_back(at->path().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace servoctl::modbus
