#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace servoctl::gateway {

/// Makes lines of bytes: each ends with LF, and a CR in front of it is left out. Of a line that is longer
/// than `longest` only the beginning is kept.
class LineReader {
 public:
  static constexpr std::size_t kLongest = 4096;

  struct Line {
    std::string text;
    bool too_long = false;
  };

  explicit LineReader(std::size_t longest = kLongest) : longest_(longest) {}

  void put(std::string_view bytes);
  /// The next line that is whole; empty when there is none.
  std::optional<Line> take();
  bool has_line() const { return bytes_.find('\n') != std::string::npos; }
  /// Bytes that are kept until a line is whole, or taken.
  std::size_t pending() const { return bytes_.size(); }

 private:
  void forget_surplus();
  void cut(std::size_t size);

  std::size_t longest_;
  std::string bytes_;
  bool cut_ = false;  ///< Of the line that `bytes_` begins with, something is missing.
};

}  // namespace servoctl::gateway
