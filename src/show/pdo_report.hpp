#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/pdo.hpp"
#include "drive/profile.hpp"
#include "report/value.hpp"

/// PDOs in words and as records (docs/json.md).
namespace servoctl::show {

/// When data of this transmission type is sent or taken over (CiA 301, tables 68 and 73): `at every SYNC`,
/// `by event`; in the family's own words where its rules say what a type of a TPDO means. `profile` may be
/// null.
std::string transmission_text(const drive::Profile* profile, canopen::PdoDirection direction,
                              std::uint8_t type);

/// Name of a mapped object, `gap` for a gap, the address when nothing is known of it.
std::string mapped_name(const drive::Profile* profile, canopen::PdoEntry entry, bool chinese);

/// The CAN-ID of a COB-ID: `0x181`; in 8 digits one of 29 bits.
std::string can_id_text(std::uint32_t cob_id);

/// `0x181 ($NODEID+0x180)`; the CAN-ID alone where the node-ID is not in it.
std::string can_id_text(const canopen::Pdo& pdo, std::uint8_t node);

/// `10 ms`, `0.5 ms`: an inhibit time, which counts 100 µs.
std::string inhibit_text(std::uint16_t inhibit);

/// One PDO of a node: `pdo direction number … entries[]`.
report::Record pdo_record(const drive::Profile* profile, const canopen::Pdo& pdo, std::uint8_t node,
                          bool chinese);

/// What a PDO sends or receives, and when, in lines for people: communication, mapping.
std::vector<std::string> pdo_lines(const drive::Profile* profile, const canopen::Pdo& pdo, std::uint8_t node,
                                   bool chinese, bool has_cob_ids = true);

}  // namespace servoctl::show
