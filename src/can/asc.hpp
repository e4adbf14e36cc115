#pragma once

#include <cstdint>
#include <string_view>

#include "base/time.hpp"
#include "can/log_clock.hpp"
#include "can/trace.hpp"

namespace servoctl::can {

/// What a line of an .asc log turned out to be.
struct AscLine {
  enum class Kind : std::uint8_t {
    frame,      ///< A classical frame, or an error frame.
    remark,     ///< Header, comment, blank line, or an event that is no frame.
    unsuited,   ///< A CAN FD frame or one of another bus system.
    malformed,  ///< Begins like a frame and does not go on like one.
  };
  Kind kind = Kind::remark;
  LogFrame frame = {};  ///< Its time counts from the beginning of the measurement.
};

/// Reads logs in the text form of Vector's tools (.asc), line by line, also as log2asc writes them:
/// `   0.012345 1  601             Rx   d 8 40 41 60 00 00 00 00 00`. Follows `base hex|dec` and
/// `timestamps absolute|relative`; without a header hexadecimal and absolute are meant. The channel becomes
/// the name of the interface: `can1` for 1.
class AscReader {
 public:
  AscLine read(std::string_view line);
  /// By the date in the header, if it is one in English or German.
  LogClock clock() const { return clock_; }

 private:
  AscLine read_event(Duration time, std::string_view rest) const;

  unsigned base_ = 16;
  bool relative_ = false;  ///< Every time counts from the line before.
  LogClock clock_;
  Duration time_{};  ///< Of the last line that had one.
};

/// Whether a file that begins like this is an .asc log.
bool is_asc(std::string_view beginning);

}  // namespace servoctl::can
