#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "od/dictionary.hpp"
#include "od/eds_findings.hpp"
#include "od/ini.hpp"

namespace servoctl::od {

/// Text of a file in a message: at most 40 columns, control characters written out.
std::string shown(std::string_view text);

/// A number as EDS files write them: `0x1F`, `31`; a leading zero is decimal, as vendors mean it, and told as
/// a warning with both readings (CiA 306-1 reads octal), and so is a comment behind it. Empty when it is none
/// or above `max`; that is told as an error.
std::optional<std::uint64_t> eds_number(const IniKey& key, std::uint64_t max, Findings& findings);

/// The value without a comment behind it, which is told: `;` begins one only at the start of a line (CiA
/// 306-1, 4.2).
std::string_view without_comment(const IniKey& key, Findings& findings);

/// What a value is for. A limit beyond its type is told as a warning, and is none. One that is to be written
/// to a device has one reading, or is refused.
enum class ValueUse : std::uint8_t { told, limit, written };

/// A value of `type`, maybe with `$NODEID` in any case and on either side of the plus. Empty when the key is
/// missing, its value empty, or wrong; the last is told as an error. Empty and told as a warning (to be
/// written: as an error) when there is no node with whose number the sum fits the type. A DOMAIN has no value
/// in a data sheet: always empty.
std::optional<NodeValue> eds_value(const IniKey* key, DataType type, Findings& findings,
                                   ValueUse use = ValueUse::told);

/// A value as eds_value() reads it. A real that is no number is written as its bits, a time as one number.
std::string eds_text(DataType type, const Value& value);

}  // namespace servoctl::od
