#pragma once

#include <cstdint>

namespace servoctl::command {

/// Keys that a person presses, each as it is pressed, without Enter.
class Keys {
 public:
  enum class Key : std::uint8_t {
    none,  ///< Nothing was pressed since the last look.
    left,
    right,
    up,
    down,
    page_up,
    page_down,
    other,
    lost,  ///< The terminal is gone.
  };

  Keys() = default;
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;
  virtual ~Keys() = default;

  /// The next key; never waits.
  virtual Key take() = 0;
  /// The letter of the last one that was `other`; 0 for none.
  virtual char character() const { return '\0'; }
};

}  // namespace servoctl::command
