#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "session/identity.hpp"
#include "session/object_scan.hpp"

/// The file of a scan that is under way, from which an interrupted one goes on.
namespace servoctl::settings {

/// Where it is kept: beside the file that is to be written.
std::filesystem::path scan_file(const std::filesystem::path& output);

/// Whose objects they are: the bus, the node-ID, 1000h, 1018h:1 to 4 and 1008h to 100Ah.
std::string identity_text(std::string_view bus, const session::Identity& identity);
/// Nothing tells this drive from others of its kind: vendor, product or serial number is missing.
bool is_one_of_many(const session::Identity& identity);

/// A line each for the drive, the ranges, how far it came, how many objects follow, the objects, and the end.
std::string scan_text(std::string_view identity, const session::ScanState& state);

struct KeptScan {
  std::string identity;
  session::ScanState state;
};
/// Whether servoctl wrote the file, in whatever state it is now.
bool is_scan_file(std::string_view text);
/// Empty for what scan_text() did not write whole, or what contradicts itself.
std::optional<KeptScan> read_scan(std::string_view text);

}  // namespace servoctl::settings
