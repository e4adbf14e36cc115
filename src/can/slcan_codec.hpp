#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "can/frame.hpp"

/// The lines of adapters that speak the ASCII protocol of the LAWICEL CAN232 (CAN232 manual, version 3;
/// drivers/net/can/slcan of Linux): each ends with a carriage return; a BEL alone is a refusal.
namespace servoctl::can {

/// What a line of an adapter turned out to be.
struct SlcanLine {
  enum class Kind : std::uint8_t {
    acknowledged,  ///< A carriage return alone, or `z`, `Z` behind a frame: the command was carried out.
    refused,       ///< BEL: it was not.
    frame,         ///< `t60184041600000000000`, `T…` (29 bits), `r`, `R` (remote).
    flags,         ///< `F04`: what happened since the flags were asked for last.
    report,        ///< `sp128096`, `e1a`: its controller, by itself (Linux 6.0 and later know them).
    text,          ///< `V1013` and anything else.
    damaged,       ///< Begins like a frame and does not go on like one; or has no end.
  };
  Kind kind = Kind::text;
  Frame frame = {};  ///< Of `frame`, and an error frame of `report`.
  /// Milliseconds, where the adapter stamps frames; they count to a minute, of some firmware to 65,536.
  std::optional<std::uint16_t> stamp = {};
  std::uint8_t flags = 0;  ///< Of `flags`.
  std::string text = {};   ///< The line as it came.
};

/// Makes lines of bytes, however they were cut. Line feeds behind carriage returns are left out, and a line
/// feed alone ends a line as well.
class SlcanReader {
 public:
  void put(std::string_view bytes);
  std::optional<SlcanLine> take();
  /// Forgets what has come, the beginning of a line too.
  void reset() { *this = SlcanReader(); }

 private:
  void end_line();
  bool is_odd_one_out(const SlcanLine& frame);

  std::string line_;
  bool too_long_ = false;  ///< The line is left out up to its end.
  bool after_return_ = false;
  /// Whether frames carry a stamp: the adapter's setting, as the first frame showed it. One that differs has
  /// lost or changed digits, unless others follow.
  std::optional<bool> stamped_;
  int odd_ones_ = 0;
  std::deque<SlcanLine> lines_;
};

/// The line of a data or remote frame, with its carriage return; the frame is one of ISO 11898-1.
std::string slcan_line(const Frame& frame);

/// The digit of `Sn` for a bitrate in bit/s; empty for one that the protocol does not have.
std::optional<char> slcan_bitrate_digit(std::uint32_t bitrate);

/// `10k, 20k, … 1M`, for messages.
std::string_view slcan_bitrates_text();

/// The error frames that SocketCAN would give for status flags (CAN232 manual, F command): bits 0 and 3 are
/// lost frames, 2 error warning, 5 error passive, 7 an error on the wire. Bit 1 (transmit queue full) is told
/// by the refusal of a frame, and lost arbitration (bit 6) is no error.
std::vector<Frame> slcan_reports(std::uint8_t flags);

}  // namespace servoctl::can
