#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "can/bus.hpp"
#include "sim/sim_bus.hpp"
#include "sim/sim_drive.hpp"

namespace servoctl::sim {

/// Simulated drives with all that belongs to them.
struct Cell {
  std::vector<std::shared_ptr<const drive::Profile>> profiles;  ///< One a family.
  std::unique_ptr<Memory> memory;
  std::vector<std::unique_ptr<SimDrive>> drives;
};

/// Builds drives from `gsd600@1,gsd600@2?state=FILE&fault=0xFF00@2s&silent=5s&delay=20ms`: families with
/// node-IDs (1 when left out); a file for their non-volatile memory; a fault or silence of all of them after
/// a time from `now`; the time every SDO answer takes. `counts=N` are the counts per motor revolution of
/// those whose objects do not report them; Errc::usage where there is none of these, and for what is wrong in
/// the text.
Result<Cell> build_cell(std::string_view text, std::span<const std::filesystem::path> folders, TimePoint now);

/// A bus in this process with these drives.
Result<std::unique_ptr<can::Bus>> open_sim(std::string_view spec,
                                           std::span<const std::filesystem::path> folders,
                                           SimBus::Clock clock);

}  // namespace servoctl::sim
