#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "session/identity.hpp"
#include "session/object_scan.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// Takes an interrupted scan of `state.ranges` from its file, if there is one of this drive; true: it goes
/// on. Not one that is damaged, or of a drive that nothing tells from others of its kind: the notices of the
/// desk say so. Errc::refused for what is no scan, and for the scan of another drive or bus, or of other
/// ranges.
Result<bool> resume_scan(show::Desk& desk, const std::filesystem::path& kept_in,
                         const session::Identity& identity, session::ScanState& state);

}  // namespace servoctl::settings
