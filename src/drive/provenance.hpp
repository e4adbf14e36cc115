#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace servoctl::drive {

struct Profile;
class TableReader;

/// A real drive that the data of a family were tried on.
struct TriedDrive {
  std::string model;     ///< As on its nameplate.
  std::string firmware;  ///< As 100Ah or its panel says it.
  std::string date;      ///< `2026-11-27`
};

/// What the data of a family were checked against, by whoever wrote them.
struct Provenance {
  std::string manual;     ///< With edition and date, in English; empty: not stated.
  std::string manual_zh;  ///< The same in Chinese.
  bool simulator = false;
  std::vector<TriedDrive> drives;  ///< Empty: nobody has tried them on a real drive yet.
};

/// Section [provenance] of a rules file. Errc::file.
Result<Provenance> read_provenance(const TableReader& reader);

/// That of a family, read from its rules file. Empty for a file of the user's own without one, for a drive
/// that describes itself, and for a family whose data sheet is its parent's: what the parent was checked
/// against says nothing about it.
Provenance provenance_of(const Profile& profile);

/// In one line: `GSD600 manual V1.0 (2023-12-22) and the simulated drive; no real drive yet`. Data that do
/// not say it: `not stated`.
std::string provenance_text(const Profile& profile, bool chinese);

}  // namespace servoctl::drive
