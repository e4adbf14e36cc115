#pragma once

#include <cstdint>
#include <string_view>

namespace servoctl::session {

/// Which services of a node are on: the states of CANopen (CiA 301, 7.3.2.2) and of EtherCAT (ETG.1000.6,
/// 6.4.1) as one set. What a node may be asked for in each is the same in both worlds.
enum class NodeState : std::uint8_t {
  unknown,           ///< It tells one that neither standard has.
  initialising,      ///< Not there yet: CANopen's boot-up, EtherCAT's INIT. Answers nothing.
  stopped,           ///< CANopen only: neither objects nor process values.
  bootstrap,         ///< EtherCAT only: takes firmware, nothing else.
  pre_operational,   ///< Objects are read and written; no process values.
  safe_operational,  ///< EtherCAT only: as before, and it tells process values; it takes none.
  operational,       ///< Objects, and process values both ways.
};

/// `unknown boot-up stopped bootstrap pre-operational safe-operational operational`
std::string_view name(NodeState state);

}  // namespace servoctl::session
