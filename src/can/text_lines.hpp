#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "can/byte_window.hpp"

namespace servoctl::can {

/// A line of a recording, without its line end, quote marks of a mail (`> `) and colours of a terminal.
struct TextLine {
  std::string_view text;     ///< Holds until the next line is taken.
  std::size_t number = 0;    ///< From 1.
  std::uint64_t offset = 0;  ///< Of its first byte in the file.
  bool ended = true;         ///< Whether a line end follows it.
};

/// The lines of a text in ASCII, UTF-8, UTF-16 with a byte order mark, or any encoding that has ASCII in it.
/// A line end is LF, CRLF or CR LF apart; a line of more than 64 KiB is taken in pieces.
class TextLines {
 public:
  explicit TextLines(ByteWindow& bytes) : bytes_(&bytes) {}

  /// False at the end.
  bool take(TextLine& out);

 private:
  void read_mark();
  bool take_bytes(std::string_view& out, bool& ended);
  std::string_view to_utf8(std::string_view wide);
  std::string_view without_dress(std::string_view line);

  ByteWindow* bytes_;
  std::size_t number_ = 0;
  std::size_t taken_ = 0;  ///< Bytes of the line before, still in the window.
  std::string text_;
  std::string bare_;
  bool begun_ = false;
  bool wide_ = false;  ///< UTF-16.
  bool big_ = false;   ///< Big-endian UTF-16.
};

}  // namespace servoctl::can
