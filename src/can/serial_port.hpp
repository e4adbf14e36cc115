#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "can/descriptor.hpp"

// Of <asm/termbits.h>, which cannot stand beside <termios.h>.
struct termios2;

namespace servoctl::can {

/// Which serial port, and how it is set.
struct SerialLine {
  std::string device;            ///< `/dev/ttyUSB0`
  std::uint32_t baud = 115'200;  ///< In bit/s, as parse_baud() takes it.
  std::uint8_t data_bits = 8;    ///< 7 or 8.
  char parity = 'N';             ///< N, E or O.
  std::uint8_t stop_bits = 1;    ///< 1 or 2.

  std::string text() const;  ///< `115200,8N1`
  bool operator==(const SerialLine&) const = default;
};

/// A baud rate of 50 to 4,000,000 bit/s. Whether a port has it is found when it is opened.
std::optional<std::uint32_t> parse_baud(std::string_view text);

/// A serial port, for this process alone (flock and TIOCEXCL), without translation of what passes. Its
/// settings are put back when it is closed.
class SerialPort {
 public:
  /// Errc::bus where the device is missing, is no serial port, may not be opened or is in use, or where it
  /// does not have the speed within two per cent; what came before is thrown away.
  static Result<SerialPort> open(const SerialLine& line);

  SerialPort(SerialPort&& other) noexcept;
  SerialPort& operator=(SerialPort&&) = delete;
  ~SerialPort();

  int get() const { return port_.get(); }

  /// All of the text, waited for until `limit`. Errc::bus when the port is gone, or does not take it in time.
  Result<void> write(std::string_view text, TimePoint limit);
  /// Adds what is there, as take_in(). Errc::bus when the port is gone.
  Result<void> read(std::string& out);
  /// Waits until all that was written has left, or for `limit`.
  void drain(TimePoint limit) const;

 private:
  int waiting() const;
  SerialPort(Descriptor port, std::string device, const termios2& before);
  tl::unexpected<Error> gone(int error) const;

  Descriptor port_;
  std::string device_;
  std::unique_ptr<termios2> before_;
};

/// The serial ports of adapters that are plugged into this machine: by the names that stay when they are
/// plugged in another order (`/dev/serial/by-id/…`), else `/dev/ttyUSB0`.
std::vector<std::string> serial_adapters();

}  // namespace servoctl::can
