#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/number.hpp"
#include "od/dictionary.hpp"
#include "od/esi_findings.hpp"
#include "od/xml.hpp"

namespace servoctl::od {

/// A number as ESI files write it (HexDecValue): `#x1A00`, `6656`, `-3`. Empty when it is none.
std::optional<Integer> esi_integer(std::string_view text);
/// The same where it fits an i64.
std::optional<std::int64_t> esi_signed(std::string_view text);

/// The number in an element's text, or in one of its attributes. `otherwise` when it is missing or empty, and
/// when it is none or above `max`, which is told as an error.
std::uint64_t esi_number(XmlElement element, std::uint64_t max, EsiFindings& findings,
                         std::uint64_t otherwise = 0);
std::uint64_t esi_attribute(XmlElement element, const char* name, std::uint64_t max, EsiFindings& findings,
                            std::uint64_t otherwise = 0);

/// `1`, `true`, in any case.
bool esi_flag(std::string_view text);

/// A text in the languages a file has it in.
struct EsiText {
  std::string english;  ///< Without LcId, or in another language, where there is no English one.
  std::string chinese;  ///< Empty: the file has none.
};

/// The texts of all children of this name: LcId 1033 is English (as are the other forms of it), 2052 Chinese.
EsiText esi_text(XmlElement parent, const char* name);

/// The values an Info element gives an entry: DefaultString, DefaultData or DefaultValue; MinData or
/// MinValue; MaxData or MaxValue. Data is bytes in hexadecimal, low byte first; a value is a number. What
/// does not fit the type is told: of a default as an error, of a limit as a warning.
void esi_values(XmlElement info, Entry& entry, EsiFindings& findings);

/// Takes away limits that are crossed, and tells them, and a default beyond its limits.
void check_esi_limits(XmlElement info, Entry& entry, EsiFindings& findings);

}  // namespace servoctl::od
