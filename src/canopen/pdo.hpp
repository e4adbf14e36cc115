#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/pdo_index.hpp"
#include "can/frame.hpp"

namespace servoctl::canopen {

using servoctl::pdo_at;
using servoctl::PdoDirection;
using servoctl::PdoPlace;

/// Bits of the COB-ID entry, sub-index 1 of the communication record (CiA 301, tables 67 and 72).
inline constexpr std::uint32_t kPdoInvalid = 0x8000'0000;
inline constexpr std::uint32_t kPdoNoRtr = 0x4000'0000;
inline constexpr std::uint32_t kPdoExtended = 0x2000'0000;  ///< A 29-bit CAN-ID.
inline constexpr std::uint32_t kPdoCobIdMask = 0x1FFF'FFFF;

/// One entry of a mapping (CiA 301, figure 73): an object, and how many of its bits. Indexes 0001h to 0007h
/// are gaps of the length of that data type.
struct PdoEntry {
  ObjectAddress object;
  std::uint8_t bits = 0;

  bool is_gap() const { return object.index < 0x0020; }
  bool operator==(const PdoEntry&) const = default;
};

/// The 32 bits of a mapping entry: index, sub-index, length.
PdoEntry parse_pdo_entry(std::uint32_t mapping);
std::uint32_t mapping_of(PdoEntry entry);

/// One PDO: communication and mapping parameter.
struct Pdo {
  PdoDirection direction = PdoDirection::receive;
  std::uint16_t number = 1;                     ///< 1..512: RPDO1 stands at 1400h and 1600h.
  std::uint32_t cob_id = kPdoInvalid;           ///< With bits 30 and 31.
  std::uint8_t type = 255;                      ///< Transmission type, sub-index 2.
  std::optional<std::uint16_t> inhibit = {};    ///< Sub-index 3, in 100 µs; empty where the drive has none.
  std::optional<std::uint16_t> event = {};      ///< Sub-index 5, in ms.
  std::optional<std::uint8_t> sync_start = {};  ///< Sub-index 6.
  std::vector<PdoEntry> entries = {};

  bool is_valid() const { return (cob_id & kPdoInvalid) == 0; }
  /// With kPdoExtended where it has 29 bits: two CAN-IDs are one when all of this is.
  std::uint32_t can_id() const { return cob_id & (kPdoExtended | kPdoCobIdMask); }
  void set_can_id(std::uint32_t can_id) { cob_id = (cob_id & ~(kPdoExtended | kPdoCobIdMask)) | can_id; }
  std::uint16_t communication_index() const;
  std::uint16_t mapping_index() const;
  std::size_t bits() const;

  bool operator==(const Pdo&) const = default;
};

/// `RPDO1`, `TPDO4`.
std::string name(PdoDirection direction, std::uint16_t number);

/// The PDO of this name, in any case, with nothing of it known yet; empty when the text names none.
std::optional<Pdo> parse_pdo_name(std::string_view text);

/// As Pdo::can_id() has it: with kPdoExtended for a frame of 29 bits.
inline std::uint32_t can_id_of(const can::Frame& frame) {
  return frame.id | (frame.extended ? kPdoExtended : 0U);
}

/// A data frame with this CAN-ID, as given by can_id_of().
can::Frame pdo_frame(std::uint32_t can_id, std::span<const std::uint8_t> data);

/// The service that CiA 301 gives this CAN-ID (7.3.5 and table 40), which no PDO may use: `NMT`, `SDO`, `a
/// reserved service`; empty when a PDO may.
std::string_view service_of(std::uint32_t can_id);

/// Cuts the data of a frame into the raw bits of each entry, low bits first, each rounded up to whole bytes;
/// gaps give empty bytes. Empty when the frame is shorter than the mapping.
std::optional<std::vector<Bytes>> unpack_pdo(std::span<const PdoEntry> entries, ByteSpan data);

/// The data of a frame that carries these values, one for each entry (gaps may be empty); excess bits of a
/// value are cut, missing ones are 0.
Bytes pack_pdo(std::span<const PdoEntry> entries, std::span<const Bytes> values);

}  // namespace servoctl::canopen
