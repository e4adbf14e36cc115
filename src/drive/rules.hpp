#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/object_address.hpp"
#include "base/result.hpp"
#include "drive/cia402.hpp"

namespace servoctl::drive {

/// An object that must hold a value.
struct Condition {
  ObjectAddress object;
  std::uint64_t value = 0;
};

/// How panel numbers map to objects: parameter n stands at `index + n / block`, sub-index `n % block +
/// first_sub`.
struct Numbering {
  std::string prefix;
  std::uint16_t index = 0;
  std::uint32_t block = 0;
  std::uint8_t first_sub = 0;
};

/// Bits 10 to 15 of the statusword at standstill in one mode of operation.
struct ModeBits {
  std::int8_t mode = 0;
  std::uint16_t disabled = 0;
  std::uint16_t enabled = 0;
};

/// What `<family>.toml` says: the rules of a family that no table can carry. Parameters are named by their
/// id.
struct Rules {
  std::string family;
  std::string vendor;
  std::string name;
  std::string name_zh;

  std::vector<Condition> identity;  ///< All must hold.
  bool identity_certain = false;    ///< False: a match is a guess, to be offered and never assumed.

  std::optional<Numbering> numbering;

  bool sdo_segmented = true;
  bool sdo_block = true;  ///< Needs sdo_segmented.
  bool sdo_exact_length = true;

  std::string node_id_parameter;
  std::string bitrate_parameter;
  std::string autostart_parameter;
  std::string guarding_alarm_parameter;  ///< 0: the end of life guarding raises no fault.
  std::uint32_t max_nodes = 127;

  std::vector<ObjectAddress> mirror_add_node_id;
  std::string restore_defaults_parameter;
  std::string clear_alarms_parameter;

  std::array<std::uint16_t, 8> statusword{};  ///< By DriveState, fault last.
  std::vector<ModeBits> mode_bits;
  std::vector<std::int64_t> quick_stop_stays_enabled;
  std::optional<Condition> fault_reset_enabled_by;
  std::uint16_t drive_alarm_code = 0xFF00;

  std::map<std::uint32_t, std::string> abort_texts_zh;
};

/// Reads a rules file. Errc::file with file and line for a syntax error, an unknown key or a value of the
/// wrong kind: a rule that is misspelt would silently not hold.
Result<Rules> parse_rules(std::string_view toml, std::string_view file);

}  // namespace servoctl::drive
