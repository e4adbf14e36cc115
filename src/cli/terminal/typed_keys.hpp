#pragma once

#include <chrono>
#include <cstddef>
#include <optional>

namespace servoctl::cli {

/// The bytes of keys that wait at a terminal, and whether a person can have typed them.
class TypedKeys {
 public:
  /// What of a paste comes behind a line break is there after so long, over a serial line too.
  static constexpr std::chrono::milliseconds kPasteGoesOn{30};

  explicit TypedKeys(int descriptor) : descriptor_(descriptor) {}

  bool wait() const;
  /// The next one; empty at the end of the input. Waits where none does.
  std::optional<char> take();
  /// Whether the last one came behind another faster than anyone types.
  bool is_burst() const { return burst_; }
  /// When the last one came.
  std::chrono::steady_clock::time_point last() const { return last_; }
  /// Drops what waits; how many bytes that were.
  std::size_t drop();

 private:
  int descriptor_;
  std::chrono::steady_clock::time_point last_{};
  bool burst_ = false;
};

}  // namespace servoctl::cli
