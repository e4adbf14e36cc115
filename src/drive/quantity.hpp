#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "drive/naming.hpp"
#include "drive/scaling.hpp"
#include "od/value.hpp"

namespace servoctl::drive {

/// What is needed to turn text into the value of one object and back: from the panel parameter where there is
/// one, else from the dictionary entry. Pointers into the profile the target came from.
struct Meaning {
  od::DataType type = od::DataType::u32;
  bool type_known = false;
  od::Access access = od::Access::rw;
  std::string_view unit;
  double scale = 1;
  std::optional<od::Value> min;
  std::optional<od::Value> max;
  std::optional<std::uint64_t> least;  ///< Below it only 0, which switches off: od::Entry::least.
  bool least_assumed = false;          ///< The manual does not state it as a limit.
  const std::vector<od::EnumLabel>* labels = nullptr;
  od::Effect effect = od::Effect::unstated;
  od::Encoding encoding = od::Encoding::plain;
  bool bits = false;  ///< Its bits are what it says: controlword, statusword, digital inputs and outputs,
                      ///< COB-IDs, mappings. Told in hexadecimal.
  bool size_known = true;          ///< False: the manual does not tell the length; the drive must be asked.
  std::optional<Measure> measure;  ///< What must be read from the drive to convert the unit.
  std::optional<Bridge> bridge;    ///< What came of it; filled in by whoever read it.
};

Meaning meaning(const Target& target, std::uint8_t node);

/// The meaning for an object that turned out to have this many bytes, where the manual does not tell its
/// length: an integer of the same sign and that length, half a float instead of a whole one.
Meaning fitted(Meaning meaning, std::size_t bytes);

/// The meaning for bytes that a drive has answered: its object may have another size than its data say, and
/// then holds an integer of the same sign in that size.
Meaning as_answered(Meaning meaning, std::size_t bytes);

/// Reads what a user writes for this object: a plain number is the raw number that the drive and its panel
/// show; a number with a unit (`60rpm`, `250ms`, `12%`) is converted and must come out exact; an enum label
/// stands for its value. Where the object carries an encoded number (`f32`), a decimal number is that number
/// and a hexadecimal one its bits. What is not zero does not become zero. Checked against type and limits.
/// Errc::usage states range and unit.
Result<od::Value> parse_quantity(const Meaning& meaning, std::string_view text);

/// Of what was asked, a value may lose so much in an object that holds whole steps; more is not what was
/// asked.
inline constexpr double kMostLoss = 0.01;
/// Less is not worth a word.
inline constexpr double kToldLoss = 0.001;

/// A number that lies between two steps of its object, and the step that stands for it; in `unit`.
struct Rounding {
  double asked = 0;
  double held = 0;
  double step = 0;
  std::string unit;
};
/// `61.5 rpm is 62 rpm: one step is 1 rpm`.
std::string to_string(const Rounding& rounding);

/// Whether `held` still is what was asked. Empty where nothing worth a word was lost; Errc::usage, with the
/// steps beside it, when what was asked becomes nothing or loses more than kMostLoss.
Result<std::optional<Rounding>> judge_rounding(const Rounding& rounding);

/// A value and what it lost.
struct Quantity {
  od::Value value;
  std::optional<Rounding> rounding;
};
/// As parse_quantity(), but a number with a unit may lie between two steps: judge_rounding() decides.
Result<Quantity> nearest_quantity(const Meaning& meaning, std::string_view text);

/// Whether the text carries a unit that only the drive's own measures can convert.
bool needs_bridge(const Meaning& meaning, std::string_view text);

/// Whether the value is neither 0 nor as much as Meaning::least.
bool is_too_little(const Meaning& meaning, const od::Value& value);

/// Checks a value against the limits; `what` names the object in the message.
Result<void> check_limits(const Meaning& meaning, const od::Value& value);

/// The number in `unit`: raw × scale without the noise of binary fractions (400 × 0.1 is 40), or the number
/// an encoded object carries.
double scaled(const Meaning& meaning, const od::Value& value);

/// The value in the unit people think in: degrees for increments, rpm for rad/s; empty when there is none.
struct Familiar {
  double value = 0;
  std::string_view unit;
};
std::optional<Familiar> familiar(const Meaning& meaning, const od::Value& value);

/// How many hexadecimal digits a number has whose bits are what it says: those of its type, where it is
/// known.
std::size_t hex_digits(const Meaning& meaning, std::uint64_t word);

/// The raw number as people read it: `400`, `-5`, `1.5` for an encoded number, `0x0270` for bits.
std::string plain_text(const Meaning& meaning, const od::Value& value);

/// What a label is called by: the whole of it, what stands before its bracket, and what stands in the bracket
/// unless that is a number: `Profile velocity (pv)`, `Profile velocity`, `pv`.
std::vector<std::string_view> label_words(std::string_view label);
/// The label that the text names, in any case, in English or Chinese; null where none does, or two.
const od::EnumLabel* find_label(const Meaning& meaning, std::string_view text);
/// The label of the value, or null.
const od::EnumLabel* label_of(const Meaning& meaning, const od::Value& value);

/// All of them: `0 Off, 1 On`.
std::string labels_text(const std::vector<od::EnumLabel>& labels);

/// `1..5000`, `at least 0`, `0, or at least 1000`, or empty when no limit is known; raw numbers.
std::string range_text(const Meaning& meaning);

}  // namespace servoctl::drive
