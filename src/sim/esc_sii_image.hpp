#pragma once

#include <cstdint>

#include "base/bytes.hpp"
#include "drive/profile.hpp"
#include "sim/object_values.hpp"

namespace servoctl::sim {

/// What is wrong with the SII of a slave.
enum class SiiFault : std::uint8_t {
  none,
  checksum,   ///< That of the configuration area.
  blank,      ///< Nothing was ever written to it.
  cut_short,  ///< A category is longer than the memory.
  mailboxes,  ///< It tells of mailboxes that the slave does not take.
  mute,       ///< The EEPROM does not answer.
};

/// The SII of a drive (ETG.1000.6, 5.4; ETG.2010): identity from 1018h and the mailboxes of the family's
/// rules, then strings, general, FMMU, sync managers and PDOs. 2 KiB.
Bytes build_sii(const drive::Profile& profile, const ObjectValues& values, std::uint16_t alias,
                SiiFault fault = SiiFault::none);

}  // namespace servoctl::sim
