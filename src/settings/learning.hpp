#pragma once

#include <filesystem>
#include <vector>

#include "report/value.hpp"
#include "session/object_scan.hpp"
#include "show/desk.hpp"

/// An EDS of a drive from what the drive itself tells. Nothing is written to the drive.
namespace servoctl::settings {

struct LearnOptions {
  std::vector<session::IndexRange> ranges = {};  ///< Empty: those of CiA 301, with all axes that answer.
  bool scans = false;           ///< Scan although the drive stores an EDS, or describes its objects.
  bool despite_alarms = false;  ///< Scan although it may raise alarms for objects that it does not have.
};

/// Writes the EDS file: the one that the drive stores (1021h, in the format of 1022h), else what it describes
/// (EtherCAT, SDO information), else what a scan finds. The file is read again before it is written. An
/// interrupted scan is kept beside it (scan_file()), and goes on from there. Answers `{node file source
/// objects entries write_only ranges resumed left_out[]}`. Errc::refused if an axis is energised, or if it
/// raises an alarm for what it lacks, or if the kept scan is of another drive; the errors of ObjectScan.
Result<report::Record> learn_sheet(show::Desk& desk, std::uint8_t node, const std::filesystem::path& file,
                                   const LearnOptions& options);

}  // namespace servoctl::settings
