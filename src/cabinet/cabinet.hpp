#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "drive/load_unit.hpp"
#include "drive/pdo_recipe.hpp"

/// What stands in a control cabinet, and what each of its drives is to have: `cabinet.toml`.
namespace servoctl::cabinet {

/// Where in the file something is written; lines and columns from 1, line 0: nowhere.
struct Place {
  std::uint32_t line = 0;
  std::uint32_t column = 0;
};

/// A bus of the cabinet, `[bus.NAME]`.
struct Bus {
  std::string name;
  std::string url;      ///< As `--bus` takes it.
  std::string bitrate;  ///< `500k`; drives that store another one get it. Empty: not said.
  Place at;
};

/// A value that a drive is to have: a parameter by its panel number, or an object by name or address.
struct Setting {
  std::string name;
  std::string value;  ///< As `param set` and `write` take it: `250ms`, `2`, a label.
  Place at;
};

/// The limits that hold for every motion of an axis unless the command line says otherwise, as its options
/// take them; empty: not said.
struct Limits {
  std::string speed;            ///< `--limit`
  std::string torque;           ///< `--max-torque`
  std::string window;           ///< `--window`
  std::string following_error;  ///< `--max-following-error`
  Place at;                     ///< Of the last table that says one of them.
};

/// The PDOs that a drive is to have; at most one of the three is said.
struct Pdos {
  std::string preset;          ///< `pp`, `pv`: of the family.
  std::filesystem::path file;  ///< As `pdo apply` takes it.
  std::vector<drive::PdoRecipe> recipes;
  Place at;
  bool said() const { return at.line != 0; }
};

/// One drive of the cabinet, `[axis.NAME]`, with what `[family.…]` and its groups say where it says nothing.
struct Axis {
  std::string name;
  std::string bus;  ///< Name of its bus.
  std::uint8_t node = 0;
  std::string family;  ///< A family, or a file, as `--drive` takes it.
  std::vector<std::string> groups;
  std::optional<std::uint32_t> serial;   ///< 1018h:04, held against the drive's.
  std::optional<std::uint64_t> turn;     ///< Increments of 6064h per motor revolution, as `--turn`.
  std::optional<std::uint64_t> encoder;  ///< Counts of the encoder per motor revolution, as `--encoder`.
  std::optional<drive::LoadUnit> load;   ///< What the load moves in one motor revolution.
  Limits limits;
  std::optional<Duration> heartbeat;  ///< Producer heartbeat time (1017h), 0 to 65535 ms; 0: none.
  Place heartbeat_at;
  Pdos pdos;
  std::vector<Setting> parameters;  ///< Each name once: the axis before its groups, the last group before the
                                    ///< others, those before its family.
  Place at;
};

/// The whole file.
struct Cabinet {
  std::filesystem::path file;
  std::vector<Bus> buses;
  std::vector<Axis> axes;  ///< In the order of the file.

  const Bus* bus(std::string_view name) const;
  const Axis* axis(std::string_view name) const;
  /// The axis at this place, or null.
  const Axis* at(std::string_view bus, std::uint8_t node) const;
  /// The axes that a list names: `feeder`, `feeder,lift`, `feeders` (a group), `all`; in the order of the
  /// file, each once. Errc::usage, with the nearest names, for one that is none.
  Result<std::vector<const Axis*>> select(std::string_view list) const;
  /// All names that select() takes, `all` left out: axes, then groups.
  std::vector<std::string> names() const;
  /// Whether an axis or a group is called so.
  bool knows(std::string_view name) const;
};

/// Reads a cabinet file. Errc::file with file, line and column for a syntax error, an unknown key, a value of
/// the wrong kind or out of its range, a name that is none or appears twice, a bus or a group that is not
/// there, two axes at one place. Families and what they know are not looked at: see check_cabinet().
Result<Cabinet> parse_cabinet(std::string_view toml, const std::filesystem::path& file);
Result<Cabinet> read_cabinet(const std::filesystem::path& file);

/// The `cabinet.toml` in this folder or the nearest above it; empty when there is none.
std::filesystem::path find_cabinet(const std::filesystem::path& folder);

/// The error of something that stands in the file at this place: `cabinet.toml:12:9: axis feeder: what`.
Error cabinet_error(const Cabinet& cabinet, const Axis& axis, Place at, const Message& what,
                    Message hint = {});

}  // namespace servoctl::cabinet
