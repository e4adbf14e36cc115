#pragma once

#include <cstdint>
#include <vector>

#include "ethercat/slave_plan.hpp"
#include "session/ethercat_network.hpp"

namespace servoctl::session {

/// Takes one slave into an exchange of process data and back. Blocks; the cycles of other slaves go on.
///
/// Up: the PDOs that are assigned (1C12h, 1C13h) are taken as they are if they carry the controlword and the
/// statusword, else those that the family's rules name are assigned until the end. Every output is preset
/// before one is sent: 607Ah with 6064h, 60FFh, 6071h and 6040h with 0, all others with what the drive holds.
/// A drive that refuses free run is run with SYNC0, which the notices of the network tell.
class EtherCatExchange {
 public:
  EtherCatExchange(EtherCatNetwork& network, EtherCatNode& node) : network_(&network), node_(&node) {}

  /// To SAFE-OP or OP. Errc::negative when the slave refuses it, with the AL status code in words;
  /// Errc::refused when an output cannot be preset. On an error everything is as it was before.
  Result<void> begin(ethercat::AlState target);
  /// SAFE-OP, PRE-OP, and the PDOs that were assigned before.
  Result<void> end();

 private:
  struct Preset {
    ObjectAddress object;
    Bytes value;
  };

  Result<void> climb(ethercat::AlState target);
  Result<Bytes> upload(ObjectAddress object);
  Result<void> download(ObjectAddress object, Bytes data);
  Result<EtherCatNode::Assignment> assigned(std::uint16_t index);
  Result<void> assign(const EtherCatNode::Assignment& assignment);
  Result<std::vector<canopen::PdoEntry>> entries(const std::vector<std::uint16_t>& pdos);
  Result<std::vector<canopen::PdoEntry>> side(std::uint16_t index, std::uint16_t wanted,
                                              ObjectAddress needed);
  Result<ethercat::ProcessMapping> mapping();
  Result<std::vector<Preset>> presets(const std::vector<canopen::PdoEntry>& outputs);
  Result<ethercat::ProcessArea> area();
  Result<bool> knows_lrw();
  Result<void> set_up(const ethercat::SlavePlan& plan);
  Result<void> write_all(const std::vector<ethercat::Request>& requests);
  Result<void> start_clock(Duration cycle);
  Result<void> flow();
  Result<void> put_assignment_back();

  EtherCatNetwork* network_;
  EtherCatNode* node_;
  unsigned fmmus_ = 0;
  bool has_clock_ = false;
  unsigned clock_bits_ = 64;
  bool synchronous_ = false;  ///< With SYNC0.
};

}  // namespace servoctl::session
