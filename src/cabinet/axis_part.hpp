#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cabinet/cabinet.hpp"
#include "drive/toml_reader.hpp"

/// What one table of a cabinet file says of axes.
namespace servoctl::cabinet {

/// What an axis, a group of axes or a family says; all of it may be missing.
struct AxisPart {
  std::string bus;
  std::string family;
  std::vector<std::uint8_t> nodes;
  std::vector<std::string> groups;
  std::optional<std::uint32_t> serial;
  std::optional<std::uint64_t> turn;
  std::optional<std::uint64_t> encoder;
  std::optional<double> gear;  ///< Motor revolutions in one of the output.
  std::optional<std::string> per_turn;
  Place per_turn_at;
  Limits limits;
  std::optional<Duration> heartbeat;
  Place heartbeat_at;
  Pdos pdos;
  std::vector<Setting> parameters;
};

enum class PartOf : std::uint8_t { axis, group, family };

/// Reads one table; which keys it may have, its kind says. Errc::file with file, line and column.
Result<AxisPart> read_part(const toml::table& table, std::string_view file, PartOf kind);

/// What `part` does not say is taken from `defaults`.
void fill_from(AxisPart& part, const AxisPart& defaults);

}  // namespace servoctl::cabinet
