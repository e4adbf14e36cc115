#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace servoctl::sim {

/// What a drive remembers of its errors: those that are present, as the error register (1001h) tells them,
/// and the pre-defined error field (1003h).
class ErrorLog {
 public:
  /// Whose error it is: each has one at a time.
  enum class Source : std::uint8_t { fault, rpdo_short, rpdo_long, master };

  /// An error begins: it stands in the history, and in the register until it ends.
  void begin(Source source, std::uint16_t code, std::uint16_t additional);
  /// False when there was none.
  bool end(Source source);
  bool is_present(Source source) const { return present_[place(source)].has_value(); }

  /// 1001h: bit 0 with every error, and the bit of its class (CiA 301, 7.5.2.2 and table 26).
  std::uint8_t error_register() const;

  /// 1003h, the newest first: bits 31-16 additional information, bits 15-0 error code.
  const std::deque<std::uint32_t>& history() const { return history_; }
  void clear_history() { history_.clear(); }
  /// How many the drive remembers.
  void set_capacity(std::size_t capacity) { capacity_ = capacity; }

 private:
  static constexpr std::size_t place(Source source) { return static_cast<std::size_t>(source); }

  std::array<std::optional<std::uint16_t>, 4> present_{};
  std::deque<std::uint32_t> history_;
  std::size_t capacity_ = 8;
};

}  // namespace servoctl::sim
