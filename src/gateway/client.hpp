#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/time.hpp"
#include "gateway/answer.hpp"

namespace servoctl::gateway {

/// Who asks a gateway: requests and bytes go in, lines to send and answers come out; no I/O. One request at a
/// time. An answer that comes after its request was given up has the number of that one, and is left out.
///
/// Lines end with CR LF. A LF alone ends one when nothing comes behind it, and from then on always: some
/// gateways write no CR.
class Client {
 public:
  static constexpr Duration kQuiet = std::chrono::milliseconds(200);
  /// More without an end of line is no gateway. An object of 5 MB has room, as hexadecimal bytes.
  static constexpr std::size_t kLongestAnswer = 16U << 20U;
  /// Of a line that is not the answer so much is kept until its end comes.
  static constexpr std::size_t kLongestOther = 65536;

  struct Outcome {
    bool silent = false;  ///< Nothing of the answer came for as long as it was waited for.
    Answer answer;
  };

  /// The line that is to be sent for this request, such as `1 4 r 0x1017 0 d`. Nothing may be under way.
  /// `patience` is how long nothing of its answer may come; what else comes makes no difference.
  std::string start(std::string_view request, TimePoint now, Duration patience);
  bool busy() const { return deadline_ != kNever; }
  TimePoint deadline() const { return std::min(deadline_, line_end_); }
  void on_bytes(std::string_view bytes, TimePoint now);
  void on_time(TimePoint now);
  /// Set once, when the request was answered or given up.
  std::optional<Outcome> take_outcome() { return std::exchange(outcome_, std::nullopt); }
  /// What came can be no answers.
  bool is_broken() const { return bytes_.size() > kLongestAnswer; }
  /// So many bytes wait for the end of their line.
  std::size_t kept() const { return bytes_.size(); }
  /// Nobody waits for the answer any more.
  void abandon() {
    deadline_ = line_end_ = kNever;
    outcome_.reset();
  }
  /// The connection is another one now.
  void reset();

 private:
  bool begins_the_answer() const;
  void forget_surplus();
  void take_lines(std::string_view end);
  void on_line(std::string_view line);

  std::uint32_t sequence_ = 0;
  Duration patience_{};
  TimePoint begun_{};
  TimePoint deadline_ = kNever;
  TimePoint line_end_ = kNever;  ///< When a LF alone is taken for one.
  bool bare_ = false;            ///< It is.
  std::string bytes_;
  std::size_t looked_ = 0;  ///< In so many of them there is no end of a line.
  std::optional<Outcome> outcome_;
};

/// What an answer carries whose line may have several: CANopenNode writes a long value in pieces, and
/// `...ERROR:0x05040000` behind it on a line of its own when the rest does not come.
Answer answer_in(std::string_view lines);

}  // namespace servoctl::gateway
