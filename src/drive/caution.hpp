#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace servoctl::drive {

/// Switches of an axis, in the order of MotionRules::inputs.
enum class Input : std::uint8_t { negative_limit, positive_limit, home };

/// What is done with a motor, for what a caution concerns.
enum class Use : std::uint8_t { enable, jog, move, home, torque };

/// A setting of the drive that makes motion more dangerous than it looks, often from the factory, and what it
/// means for motions. docs/drive-data.md describes the keys.
struct Caution {
  std::string name;                       ///< Parameter or object; empty: it always holds.
  std::optional<std::int64_t> value;      ///< It holds while `name` has this value,
  std::optional<std::int64_t> not_value;  ///< or has any but this one.
  std::vector<std::string> others;        ///< And only while that is true of all of these as well.
  std::optional<std::int64_t> set;        ///< The value of `name` that ends it.
  std::string text;                       ///< Beside what is made of the keys below.
  std::string text_zh;
  std::vector<Use> concerns;          ///< Empty: every use.
  std::vector<Input> masks;           ///< Switches that the drive ignores.
  std::vector<Use> blocks;            ///< What cannot be done at all.
  std::vector<std::int64_t> methods;  ///< Values of 6098h that cannot be used.
  std::string speed;                  ///< Speed that needs --limit above it, `120rpm`.
  std::string torque;                 ///< Torque that needs --max-torque above it, `3Nm`.

  bool is_conditional() const { return value || not_value; }
  bool holds(double now) const {
    return value ? now == static_cast<double>(*value) : !not_value || now != static_cast<double>(*not_value);
  }
  bool concerns_use(Use use) const {
    return concerns.empty() || std::find(concerns.begin(), concerns.end(), use) != concerns.end();
  }
  bool masks_input(Input input) const { return std::find(masks.begin(), masks.end(), input) != masks.end(); }
  /// Whether it may refuse a motion.
  bool is_rule() const { return !masks.empty() || !blocks.empty() || !methods.empty(); }
};

}  // namespace servoctl::drive
