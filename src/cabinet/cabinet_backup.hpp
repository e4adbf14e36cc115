#pragma once

#include <span>

#include "cabinet/station.hpp"

namespace servoctl::cabinet {

/// Saves the settings of all axes into a folder beside the cabinet file that is named after the time, with a
/// copy of the file: `backup-2026-11-22T19-40-00Z/feeder.json`. It has its name when all is in it. An axis
/// that is not to be had is missing there, and in `desk.errors`. Errc::file; without a single axis the error
/// of the first.
Result<report::Value> back_up_cabinet(show::Desk& desk, const Cabinet& cabinet,
                                      std::span<const Station> stations,
                                      std::span<const drive::Family> families);

}  // namespace servoctl::cabinet
