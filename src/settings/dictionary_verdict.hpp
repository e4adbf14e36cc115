#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "report/value.hpp"
#include "settings/dictionary_check.hpp"

namespace servoctl::settings {

/// `{node file entries read probed differences not_default written findings[{index sub name finding file
/// drive}] unchecked[{index sub name reason}]}`. Differences make an error in the desk.
report::Record dictionary_record(show::Desk& desk, const std::string& file, const DictionaryCheck& check);

/// As JUnit XML: a suite for each node, a case for each entry of the file and for each that it lacks.
std::string dictionary_junit(const od::EdsFile& file, const std::vector<DictionaryCheck>& checks);

}  // namespace servoctl::settings
