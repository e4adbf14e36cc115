#pragma once

#include <string>
#include <vector>

#include "report/value.hpp"

namespace servoctl::traffic {

/// One thing that a look at a bus shows.
struct Finding {
  enum class Level : std::uint8_t {
    ok,
    note,   ///< Worth knowing; nothing is wrong.
    fault,  ///< Something is wrong, or very likely so.
  } level = Level::ok;
  std::string code;   ///< For scripts: `wrong-bitrate`.
  std::string text;   ///< What is so.
  std::string means;  ///< What it means; may be empty.
  std::string mend;   ///< What to do about it, with the command; may be empty.
};

/// `duplicate-node`, a fault. `noticed`: what showed it, as session::Duplicates words it.
Finding two_nodes(std::uint8_t node, std::string_view noticed);

/// How the bitrate of this bus is found, with the command.
std::string bitrate_search(std::string_view url);

std::string_view name(Finding::Level level);  ///< `ok note fault`

/// The findings of one bus or interface.
struct Findings {
  std::string bus;  ///< `can0`, `coe:eth0`; empty: of this machine.
  std::vector<Finding> list = {};
};

/// How many are faults.
std::size_t faults_in(const std::vector<Findings>& all);

/// For people one block each, a line or three a finding; for scripts one object each.
report::Value findings_value(const std::vector<Findings>& all);

}  // namespace servoctl::traffic
