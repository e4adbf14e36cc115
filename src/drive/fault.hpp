#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "drive/rules.hpp"
#include "od/doubts.hpp"

namespace servoctl::drive {

/// One line of a family's faults table (docs/drive-data.md).
struct Fault {
  enum class Kind : std::uint8_t { fault, warning, status };
  std::optional<std::uint16_t> code;  ///< As in 603Fh and EMCY; empty where the manual prints none.
  std::string extra;                  ///< The vendor's second code, as printed.
  std::string panel;                  ///< What the panel shows.
  Kind kind = Kind::fault;
  std::optional<bool> resettable;  ///< Empty: the manual does not say.
  std::string name;
  std::string name_zh;
  std::string check;  ///< Cause and remedy.
  std::string check_zh;
  od::Doubts doubts;
  std::uint32_t line = 0;
};

std::string_view name(Fault::Kind kind);  ///< `fault warning status`

/// Reads `<family>.faults.csv`; of its columns only `name` is needed. Errc::file with file and line for a bad
/// cell, a code without `0x` or `h`, a fault that appears twice, or an unknown column: the first of them.
Result<std::vector<Fault>> parse_faults(std::string_view csv, std::string_view file);
/// The same of all rows that are right; adds everything that is wrong to `errors`.
std::vector<Fault> read_faults(std::string_view csv, std::string_view file, std::vector<Error>& errors);

/// What the panel shows for an emergency, by the family's layout of the vendor bytes (`Er12-2`); empty when
/// they do not tell.
std::string panel_text(const EmergencyRules& rules, const std::array<std::uint8_t, 5>& vendor);

/// The vendor bytes of an emergency for this panel text; zeros where the layout is not known.
std::array<std::uint8_t, 5> panel_bytes(const EmergencyRules& rules, std::string_view panel);

/// All that a code may stand for: the one whose panel text the vendor bytes give, else every fault that
/// shares the code.
std::vector<const Fault*> faults_of(std::span<const Fault> faults, const EmergencyRules& rules,
                                    std::uint16_t code, const std::array<std::uint8_t, 5>& vendor = {});

}  // namespace servoctl::drive
