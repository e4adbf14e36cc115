#pragma once

#include <string>
#include <vector>

#include "drive/profile.hpp"
#include "report/value.hpp"

/// Objects of a dictionary as they are shown.
namespace servoctl::show {

/// One entry, with what the table of parameters says of it; its text fields are the columns of `objects`.
report::Record object_record(const drive::Profile& profile, const od::Object& object, const od::Entry& entry,
                             bool chinese);

/// Adds a record as a row; the first one makes the columns.
void add_object_row(report::Table& table, report::Record record);

/// One entry in full, for people: with limits, the meanings of its values, and notes. In JSON as
/// object_record().
report::Record object_details(const drive::Profile& profile, const od::Object& object, const od::Entry& entry,
                              bool chinese);

/// What the values of an entry stand for: `3 Profile velocity mode`, in their order.
std::vector<std::string> object_values(const drive::Profile& profile, const od::Entry& entry, bool chinese);

/// Errc::negative for a family without parameters: then none fits, whatever is looked for.
Result<void> check_parameters(const drive::Profile& profile);

}  // namespace servoctl::show
