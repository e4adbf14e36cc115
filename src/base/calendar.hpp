#pragma once

#include <string>

namespace servoctl {

/// The present in UTC, `2026-11-21T12:00:00Z` (ISO 8601). $SOURCE_DATE_EPOCH (seconds since 1970) stands for
/// it where output has to be the same every time.
std::string utc_now_text();

}  // namespace servoctl
