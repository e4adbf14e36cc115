#pragma once

#include "base/bytes.hpp"
#include "hex.hpp"

namespace servoctl::ethercat {

/// An SII with everything in it that servoctl reads, written by hand from the tables of ETG.1000.6, 5.4; rows
/// of categories 40, 41, 50 and 60 as in dumps/eeprom/akd.hex of ethercrab (MIT or Apache-2.0).
inline Bytes full_sii() {
  auto out =
      hex("0900 0008 0000 0000 0500 0000 0000"  // Words 0..6: alias 5.
          "0000"                                // The checksum, below.
          "6A000000 444B4100 02000000 93008399"
          "0000000000000000"
          "0010 8000 8010 8000"  // Bootstrap mailbox.
          "0018 0004 001C 0004"  // Mailbox.
          "0E00");
  out.resize(0x7C);
  const auto rest =
      hex("0F00 0100"
          "0A00 0A00 04 03414B44 054472697665 06446353796E63 00 00"  // Strings: AKD, Drive, DcSync, empty.
          "1E00 1000 02 00 01 02 01 3D 01 03 00 01 00 05 00000300 1100 0000000000000000000000000000"
          "2800 0200 010203FF"
          "2900 1000 00180004 26 00 01 01 001C0004 22 00 01 02 00110000 24 00 01 03 40110000 20 00 01 04"
          "3200 0C00 011A 01 FF 00 02 0000 4160 00 01 06 10 0000 011B 00 03 00 00 1000"
          "3300 0C00 0116 02 02 00 01 0000 4060 00 01 06 10 0000 0000 00 00 00 08 0000"
          "3C00 0C00 00000000 00000000 00000000 0000 0003 0100 03 00 00000000"
          "FFFF FFFF");
  out.insert(out.end(), rest.begin(), rest.end());
  out[14] = 0x9D;
  return out;
}

}  // namespace servoctl::ethercat
