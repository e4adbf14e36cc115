#pragma once

#include <termios.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "base/time.hpp"
#include "can/descriptor.hpp"

namespace servoctl::can {

/// What stands behind `slcan:`.
struct SlcanPlace {
  std::string device;            ///< `/dev/ttyACM0`
  std::uint32_t bitrate = 0;     ///< Of the bus, in bit/s; one of the protocol's nine.
  std::uint32_t baud = 115'200;  ///< Of the serial line; of no consequence where that is USB itself.
  bool operator==(const SlcanPlace&) const = default;
};

/// Reads `/dev/ttyACM0@1M`, `/dev/ttyUSB0@500k,57600`. Errc::usage with the form, and with the bitrates that
/// there are.
Result<SlcanPlace> parse_slcan_place(std::string_view text);

/// A serial port, for this process alone (flock and TIOCEXCL), without translation of what passes. Its
/// settings are put back when it is closed.
class SerialPort {
 public:
  /// Errc::bus where the device is missing, is no serial port, may not be opened or is in use; what came
  /// before is thrown away. Errc::usage for a baud rate that it does not have.
  static Result<SerialPort> open(const std::string& device, std::uint32_t baud);

  SerialPort(SerialPort&&) = default;
  SerialPort& operator=(SerialPort&&) = delete;
  ~SerialPort();

  int get() const { return port_.get(); }

  /// All of the text, waited for until `limit`. Errc::bus when the port is gone, or does not take it in time.
  Result<void> write(std::string_view text, TimePoint limit);
  /// Adds what is there. Errc::bus when the port is gone.
  Result<void> read(std::string& out);
  /// Waits until all that was written has left, or for `limit`.
  void drain(TimePoint limit) const;

 private:
  int waiting() const;
  SerialPort(Descriptor port, std::string device, const termios& before);
  tl::unexpected<Error> gone(int error) const;

  Descriptor port_;
  std::string device_;
  termios before_;
};

}  // namespace servoctl::can
