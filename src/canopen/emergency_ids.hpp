#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "can/frame.hpp"
#include "canopen/emergency.hpp"

namespace servoctl::canopen {

/// Under which CAN-IDs nodes send emergencies: 080h and the node-ID (CiA 301, 7.3.5), and what their 1014h
/// was seen to say. What nobody has read since the bus was opened, or behind a restart changed without a
/// word, it does not know.
class EmergencyIds {
 public:
  /// 1014h of the node (1..127) holds this. The pre-defined CAN-ID counts on: the node may restart with it. A
  /// CAN-ID that CiA 301 keeps for another service (table 40) is not taken over, nor one that is switched off
  /// by bit 31. A node that is known to have its own pre-defined CAN-ID has it, whoever else claimed it.
  void learn(std::uint8_t node, std::uint32_t cob_id);

  /// The node may have lost what was not stored: a CAN-ID that another node has by its number is that node's.
  void on_boot_up(std::uint8_t node);

  /// Takes an EMCY frame apart, as parse_emergency() does.
  std::optional<Emergency> parse(const can::Frame& frame) const;

 private:
  struct Changed {
    std::uint8_t node;
    std::uint32_t can_id;  ///< As can_id_of() has it.
  };
  std::vector<Changed> changed_;
};

}  // namespace servoctl::canopen
