#pragma once

#include <span>
#include <string>
#include <vector>

#include "drive/profile.hpp"
#include "od/eds.hpp"
#include "report/value.hpp"

/// Objects of a dictionary as they are shown.
namespace servoctl::show {

/// One entry, with what the table of parameters says of it; its text fields are the columns of `objects`.
/// `notes`: what the data sheet says beside the dictionary.
report::Record object_record(const drive::Profile& profile, const od::Object& object, const od::Entry& entry,
                             std::span<const od::EntryNote> notes, bool chinese);

/// Entries as a table: of each what fits a line in text, everything in JSON.
report::Table object_table(std::vector<report::Record> records);

/// One entry in full, for people: with limits, the meanings of its values, and notes. In JSON as
/// object_record().
report::Record object_details(const drive::Profile& profile, const od::Object& object, const od::Entry& entry,
                              bool chinese);

/// What the values of an entry stand for: `3 Profile velocity mode`, in their order.
std::vector<std::string> object_values(const drive::Profile& profile, const od::Entry& entry, bool chinese);

/// Errc::negative for a family without parameters: then none fits, whatever is looked for.
Result<void> check_parameters(const drive::Profile& profile);

}  // namespace servoctl::show
