#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"

namespace servoctl::ethercat {

inline constexpr std::size_t kSiiHeader = 0x40;      ///< Words in front of the first category.
inline constexpr std::uint16_t kSiiEnd = 0xFFFF;     ///< Type of the category behind the last.
inline constexpr std::size_t kMaxSiiWords = 0x8000;  ///< 64 KiB; no slave has more.

/// Where the mailboxes of a slave are; all 0 where it has none. Out and in are the master's.
struct SiiMailbox {
  std::uint16_t out_start = 0;
  std::uint16_t out_size = 0;
  std::uint16_t in_start = 0;
  std::uint16_t in_size = 0;

  bool exists() const { return out_size != 0 && in_size != 0; }
  /// Why it cannot be used as it is; empty when it can, or does not exist.
  std::string doubt() const;
  bool operator==(const SiiMailbox&) const = default;
};

/// Protocols of a mailbox (SII word 1Ch).
inline constexpr std::uint16_t kProtocolEoe = 0x02;
inline constexpr std::uint16_t kProtocolCoe = 0x04;
inline constexpr std::uint16_t kProtocolFoe = 0x08;

/// What its CoE can do (byte 5 of the general category).
inline constexpr std::uint8_t kCoeSdo = 0x01;
inline constexpr std::uint8_t kCoeInfo = 0x02;
inline constexpr std::uint8_t kCoeAssign = 0x04;     ///< 1C12h and 1C13h can be written.
inline constexpr std::uint8_t kCoeConfigure = 0x08;  ///< Mappings can be written.
inline constexpr std::uint8_t kCoeUploadAtStart = 0x10;
inline constexpr std::uint8_t kCoeCompleteAccess = 0x20;

/// One row of category 41.
struct SiiSyncManager {
  enum class Use : std::uint8_t { unused = 0, mailbox_out = 1, mailbox_in = 2, outputs = 3, inputs = 4 };
  std::uint16_t start = 0;
  std::uint16_t length = 0;
  std::uint8_t control = 0;
  std::uint8_t enable = 0;
  Use use = Use::unused;
};

struct SiiPdoEntry {
  ObjectAddress object;  ///< Index 0: a gap.
  std::string name;
  std::uint8_t data_type = 0;  ///< CiA 301, 7.4.7.
  std::uint8_t bits = 0;
};

/// One PDO of category 50 or 51.
struct SiiPdo {
  std::uint16_t index = 0;  ///< 1600h.. or 1A00h..
  std::string name;
  std::uint8_t sync_manager = 0xFF;  ///< That it is assigned to by default; 255: to none.
  std::uint16_t flags = 0;           ///< Bit 4: its content is fixed.
  std::vector<SiiPdoEntry> entries;

  std::size_t bits() const;
};

/// One row of category 60: a way of working with distributed clocks.
struct SiiDcMode {
  std::string name;
  std::uint32_t cycle0 = 0;    ///< ns; 0: the cycle of the master.
  std::uint32_t shift0 = 0;    ///< ns
  std::uint16_t activate = 0;  ///< 0980h and 0981h; 0: this mode goes without SYNC signals.
};

/// The content of a slave's SII (ETG.1000.6, 5.4; ETG.2010), as far as it could be read. Everything that is
/// wrong with it is a doubt in words; what a doubt is about is empty or 0.
struct SiiImage {
  std::uint16_t alias = 0;
  std::uint32_t vendor = 0;
  std::uint32_t product = 0;
  std::uint32_t revision = 0;
  std::uint32_t serial = 0;
  SiiMailbox bootstrap;
  SiiMailbox mailbox;
  std::uint16_t protocols = 0;
  std::size_t size = 0;              ///< Bytes that the memory has by its own word 3Eh; 0: not said.
  std::vector<std::string> strings;  ///< The first is number 1.
  std::string name;
  std::string order;
  std::string group;
  std::uint8_t coe = 0;  ///< kCoe… bits.
  bool has_general = false;
  std::vector<std::uint8_t> fmmu_use;  ///< 1 outputs, 2 inputs, 3 status of a mailbox.
  std::vector<SiiSyncManager> sync_managers;
  std::vector<SiiPdo> tx_pdos;
  std::vector<SiiPdo> rx_pdos;
  std::vector<SiiDcMode> dc_modes;
  std::vector<std::string> doubts;

  /// Nothing is in it: identity and mailboxes have to come from elsewhere.
  bool is_empty() const { return vendor == 0 && product == 0; }
  const SiiSyncManager* sync_manager(SiiSyncManager::Use use) const;
};

/// The checksum of the first 14 bytes: CRC-8 of the polynomial 07h that begins with FFh (ETG.1000.6, 5.4).
std::uint8_t sii_checksum(ByteSpan configuration);

SiiImage parse_sii(ByteSpan image);

}  // namespace servoctl::ethercat
