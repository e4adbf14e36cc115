#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "can/log_row.hpp"

namespace servoctl::can {

/// How a tool writes a frame into a line of words with blanks between them.
struct LogFormat {
  std::string_view name;
  /// One word each, `?` behind those that may be missing, `*` behind those that may come several times:
  /// `number time clock fraction chan id dec len data dir word any`; a word in the line itself stands with
  /// `=` in front, `|` between several. `data` are as many bytes as the length says, or all that are there.
  std::string_view pattern;
  LogNumbers numbers;
};

/// All that are known, the most particular first.
std::span<const LogFormat> log_formats();

/// Matches lines with one format.
class LogPattern {
 public:
  explicit LogPattern(const LogFormat& format);

  /// The cells of a line; false where it is not of this form. A remark behind the frame is left out.
  bool match(std::string_view line, LogCells& out);
  const LogFormat& format() const { return *format_; }

 private:
  struct Word {
    std::string_view what;
    bool optional = false;
    bool repeats = false;
  };

  bool match_from(std::size_t word, std::size_t at, LogCells& out);
  bool match_data(std::size_t word, std::size_t at, LogCells& out);
  bool is_tail(std::size_t at, const LogCells& cells) const;

  const LogFormat* format_;
  std::vector<Word> words_;
  std::vector<std::string_view> line_;
  std::size_t steps_ = 0;  ///< Of one line; a limit against lines made to take long.
};

}  // namespace servoctl::can
