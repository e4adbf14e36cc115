#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace servoctl::drive {

/// The settings for one PDO; what is not given stays unchanged.
struct PdoRecipe {
  std::string pdo;  ///< `TPDO1`
  std::optional<std::vector<std::string>>
      map;             ///< Objects by name or address, `0x6041:0/16` with their bits.
  std::string cob_id;  ///< `$NODEID+0x180`, `0x181`; empty: not said.
  std::optional<bool> valid;
  std::optional<std::uint8_t> type;
  std::optional<std::uint32_t> inhibit_us;
  std::optional<std::uint16_t> event_ms;
  std::optional<std::uint8_t> sync_start;
  std::uint32_t line = 0;  ///< Of the file; 0: unknown.
};

/// A mapping a manual recommends for one mode of operation.
struct PdoPreset {
  std::string name;  ///< `pp pv pt home ip csp csv cst`
  std::vector<PdoRecipe> pdos;
};

/// The PDOs of a drive as they stand in a file.
struct PdoFile {
  std::string family;  ///< Empty where the file does not say it.
  std::vector<PdoRecipe> pdos;
};

/// Reads a file of PDOs, `format = 1`, `family`, `[[pdo]]`. Errc::file with file and line for a syntax error,
/// an unknown key, a value of the wrong kind.
Result<PdoFile> parse_pdo_file(std::string_view toml, std::string_view file);

}  // namespace servoctl::drive
