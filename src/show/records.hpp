#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "od/parameter.hpp"
#include "report/value.hpp"
#include "show/desk.hpp"

/// The records that scripts rely on (docs/json.md), built in one place.
namespace servoctl::show {

/// What an abort code means: the manual's own words where the family's rules have them in this language, else
/// those of CiA 301. `profile` may be null.
std::string abort_words(const drive::Profile* profile, bool chinese, std::uint32_t code);
std::string abort_words(const Desk& desk, std::uint32_t code);
/// Of the abort code of an error, in English, for records; empty when it has none.
std::string abort_words(const Desk& desk, const Error& error);

/// Puts these words into the message of an abort: in place of "not listed in CiA 301", and of the standard's
/// words in Chinese.
void name_abort(const drive::Profile* profile, bool chinese, Error& error);

/// An error as it stands in JSON, every key there; its `axis` is null, AxisNames::put_into() says it.
/// `abort_words`: what its abort code means on this drive; empty: as in CiA 301.
report::Value error_record(const Error& error, std::string_view abort_words = {});

/// `{"min":[2240,2260]}`: fields and the lines of the manual; null when there are none.
report::Value marks_record(const std::vector<od::Mark>& marks);

/// What the manual does not state, and what it contradicts: sentences in text, records in JSON.
report::Record doubts_record(const od::Doubts& doubts);

/// A value of the dictionary as a number, text, or bytes in hexadecimal; null when there is none.
report::Value od_value(const std::optional<od::Value>& value);

/// `{"0":"Position mode"}` in JSON, `0 Position mode, 1 …` in text; null without labels.
report::Value labels_record(std::span<const od::EnumLabel> labels, bool chinese);

/// One panel parameter.
report::Record parameter_record(const od::Parameter& parameter, bool chinese);

/// Panel parameters as a table: what fits a line in text, everything in JSON.
report::Table parameter_table(std::span<const od::Parameter* const> parameters, bool chinese);
/// Says below a table whose column `mark` has od::Doubts::sign() what the signs mean, where there is one.
void explain_marks(report::Table& table);

/// Adds node and object to an error that has none.
Error located(Error error, std::uint8_t node, ObjectAddress object);

/// Whether `text` contains `word`, ASCII case ignored.
bool contains_nocase(std::string_view text, std::string_view word);

/// Whether `text` fits `pattern`, in which `*` stands for anything; ASCII case ignored.
bool fits(std::string_view pattern, std::string_view text);

}  // namespace servoctl::show
