#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "report/value.hpp"
#include "session/drive_units.hpp"
#include "show/desk.hpp"

/// Values read from drives, taken apart for a reader and for JSON.
namespace servoctl::show {

/// What was read from, or is to be written to, one object of one node.
struct Reading {
  std::uint8_t node = 0;
  drive::Target target;
  std::optional<od::DataType> type;  ///< Overrides the dictionary's type.
  Result<Bytes> bytes = Bytes{};
  std::optional<drive::Bridge> bridge = {};    ///< What the drive's own measures say of the unit.
  const session::DriveUnits* units = nullptr;  ///< The drive's own, in the place of those its data assume.
  const drive::Profile* family = nullptr;      ///< Whose digital inputs are told in words.
  bool one_of_many = false;  ///< Of a record or a pattern: that the drive refuses it is an answer.
};

/// A word of bits, and the object that holds it.
struct WordOfObject {
  ObjectAddress object;
  std::uint64_t value = 0;
  const drive::Profile* family = nullptr;
};

/// The value of an object, taken apart for a reader and for JSON.
struct DecodedValue {
  report::Value value;     ///< In its unit.
  report::Value raw;       ///< The number as it is sent; null when the bytes do not fit the type.
  report::Value label;     ///< Of an enum, or null.
  report::Value label_zh;  ///< In Chinese, or null.
  std::string unit;
  report::Value
      familiar;      ///< `{"value":90,"unit":"deg"}`: in the unit people think in; null when there is none.
  std::string text;  ///< What a person reads: number and unit; the beginning of a long value.
  std::string type;
  report::Value encoding;                 ///< `f32`, `f32hi` or null.
  std::optional<WordOfObject> word = {};  ///< Where value_words() tell what it means.
};
DecodedValue decode_value(const Reading& reading, ByteSpan bytes);

/// Shows no unit that the data only assume: it is not the drive's.
void leave_units_open(Reading& reading);

/// The label, or what the bits of a word mean; empty where there is none.
std::string label_text(const DecodedValue& value, bool chinese);
/// The same for where there is little room: without the bits.
std::string brief_label(const DecodedValue& value, bool chinese);

/// The value in the unit people think in, as text (`90 deg`) and as a record; empty and null without one.
struct FamiliarValue {
  std::string text;
  report::Value record;
};
FamiliarValue familiar_value(const drive::Meaning& meaning, const od::Value& value);

/// Readings as a table, with what the drive's gear makes of them; an `error` in the rows that failed. Errors
/// are added to `desk.errors`, but refusals of one_of_many only where nothing at all could be read.
report::Table reading_table(Desk& desk, std::vector<Reading> readings);

/// Bytes of the object by its type; 0 when the type is not known or of no fixed size.
std::size_t size_of(const Reading& reading);

/// The type used to decode `bytes`: the given one, else the dictionary's, else one that fits the length.
od::DataType type_of(const Reading& reading, ByteSpan bytes);

}  // namespace servoctl::show
