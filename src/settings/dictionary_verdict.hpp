#pragma once

#include <cstdint>
#include <string>

#include "base/result.hpp"
#include "report/value.hpp"
#include "report/verdict.hpp"
#include "settings/dictionary_check.hpp"

namespace servoctl::settings {

/// `{node file entries read probed differences not_default findings[{index sub name finding file
/// drive}] unchecked[{index sub name reason}]}`. Differences make an error in the desk.
report::Record dictionary_record(show::Desk& desk, const std::string& file, const DictionaryCheck& check);

/// As a test, for JUnit: a criterion for each entry of the file and for each that it lacks.
report::TestResult dictionary_test(const od::EdsFile& file, const DictionaryCheck& check);
/// The same of a node that could not be compared: one that failed.
report::TestResult dictionary_test(std::uint8_t node, const Error& error);

}  // namespace servoctl::settings
