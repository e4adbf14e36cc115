#include "modbus/serial_port.hpp"

#include <poll.h>

#include <algorithm>
#include <string>

#include "base/format.hpp"

namespace servoctl::modbus {
namespace {

using can::Wake;
using std::chrono::milliseconds;

/// How long send() tries while the queue of the port is full.
constexpr Duration kSendPatience = std::chrono::seconds(1);
constexpr Duration kReopenPause = milliseconds(20);

}  // namespace

Duration SerialPort::silence() const {
  if (settings_.framing != Framing::rtu) return Duration::zero();
  constexpr std::uint32_t kFixedAbove = 19200;
  if (settings_.line.baud > kFixedAbove) return Duration(1750);
  const auto characters = 35ULL * settings_.bits_per_character() * 1'000'000ULL / 10U;
  return Duration(static_cast<Duration::rep>(characters / settings_.line.baud));
}

tl::unexpected<Error> SerialPort::not_open() const {
  return fail(Errc::bus, message("{} is gone", settings_.line.device),
              "was the adapter unplugged? plug it in again");
}

Result<void> SerialPort::send(ByteSpan bytes) {
  if (!port_) return not_open();
  return port_->write(as_text(bytes), now() + kSendPatience);
}

Result<Bytes> SerialPort::receive(TimePoint deadline) {
  if (!port_) return not_open();
  if (can::wait_or_signal(port_->get(), POLLIN, deadline) != Wake::ready) return Bytes();
  std::string text;
  const auto got = port_->read(text);
  if (!got && text.empty()) return fail(got.error());
  return Bytes(text.begin(), text.end());
}

Result<void> SerialPort::reopen(TimePoint deadline) {
  port_.reset();
  for (;;) {
    auto again = can::SerialPort::open(settings_.line);
    if (again) {
      port_.emplace(std::move(*again));
      return {};
    }
    if (now() >= deadline) return fail(again.error());
    if (can::wait_or_signal(-1, 0, std::min(deadline, now() + kReopenPause)) == Wake::interrupted)
      return fail(again.error());
  }
}

Result<std::unique_ptr<Port>> open_serial(const SerialSettings& settings) {
  auto port = can::SerialPort::open(settings.line);
  if (!port) return fail(port.error());
  return std::make_unique<SerialPort>(std::move(*port), settings);
}

}  // namespace servoctl::modbus
