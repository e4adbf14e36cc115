#pragma once

#include "od/dictionary.hpp"
#include "session/object_survey.hpp"
#include "settings/dictionary_check.hpp"

/// Objects of a live drive that its data sheet does not list.
namespace servoctl::settings {

/// Asks for the neighbours of listed indexes, as long as there are more, for the standard objects that the
/// file lacks (`standard` may be null), and in arrays and records for the sub-indices up to what sub 0 says
/// and one more. `out.values` has what was read of the file's objects. False where an axis of the drive was
/// enabled meanwhile: then nothing more is asked for.
Result<bool> probe_unlisted(session::ObjectSurvey& survey, const od::Dictionary& file,
                            const od::Dictionary* standard, EntryJudge& judge, DictionaryCheck& out);

/// What the drive describes itself: entries that the file lacks, other types of the same size, other access.
void compare_description(const od::Dictionary& described, const od::Dictionary& file, EntryJudge& judge,
                         DictionaryCheck& out);

}  // namespace servoctl::settings
