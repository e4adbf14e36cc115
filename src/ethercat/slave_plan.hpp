#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.hpp"
#include "base/result.hpp"
#include "canopen/pdo.hpp"
#include "ethercat/request.hpp"
#include "ethercat/sii_image.hpp"

namespace servoctl::ethercat {

/// What the PDOs assigned to 1C12h and 1C13h carry, in their order; gaps included.
struct ProcessMapping {
  std::vector<canopen::PdoEntry> outputs;  ///< RxPDOs: from the master.
  std::vector<canopen::PdoEntry> inputs;   ///< TxPDOs: from the drive.
};

std::size_t bits_of(std::span<const canopen::PdoEntry> entries);
/// Bytes that a sync manager has for them.
std::size_t bytes_of(std::span<const canopen::PdoEntry> entries);

/// Where a slave keeps its process data: from its SII, or from what is known of its family.
struct ProcessArea {
  std::uint8_t out_manager = 2;  ///< Number of the sync manager.
  std::uint16_t out_start = 0;
  std::uint8_t out_control = 0;
  std::uint8_t in_manager = 3;
  std::uint16_t in_start = 0;
  std::uint8_t in_control = 0;

  bool exists() const { return out_start != 0 && in_start != 0; }
};
/// As category 41 has it; does not exist where the SII says nothing.
ProcessArea process_area(const SiiImage& image);

/// The 8 bytes of a sync manager's registers (ETG.1000.4, table 59). A length of 0 switches it off.
Bytes sync_manager_bytes(std::uint16_t start, std::uint16_t length, std::uint8_t control);
/// The 16 bytes of an FMMU's registers (ETG.1000.4, table 57), whole bytes. A length of 0 switches it off.
Bytes fmmu_bytes(std::uint32_t logical, std::uint16_t length, std::uint16_t physical, std::uint8_t type);
/// The write that sets SM0 and SM1 for a mailbox: in INIT, before PRE-OP.
Request mailbox_setup(SlaveAddress slave, const SiiMailbox& mailbox);

/// The settings that let process data flow: sync managers and FMMUs of one slave. Its outputs stand at
/// `logical`, its inputs behind them.
struct SlavePlan {
  ProcessArea area;
  std::uint32_t logical = 0;
  std::uint16_t out_size = 0;  ///< Bytes
  std::uint16_t in_size = 0;

  /// The writes, in their order: in PRE-OP, before SAFE-OP. `watchdog`: the slave is to notice when no
  /// outputs come.
  std::vector<Request> requests(SlaveAddress slave, bool watchdog = true) const;
};

/// `node` 1..127 is for messages. Errc::usage when the mapping does not fit into the slave's memory: each
/// sync manager has three buffers, one behind the other.
Result<SlavePlan> plan_slave(std::uint8_t node, const ProcessArea& area, const ProcessMapping& mapping,
                             std::uint32_t logical);

}  // namespace servoctl::ethercat
