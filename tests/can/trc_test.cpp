// Lines are in the form of PEAK's description of the format (PEAK CAN TRC File Format, 2020), versions 1.0
// to 2.1.
#include "can/trc.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "can/recording.hpp"

namespace servoctl::can {
namespace {

using Frames = std::vector<std::string>;

/// What for_each_frame() makes of a file, frames in the notation of candump; then what was left out.
Frames read_trace(std::string_view text) {
  Frames out;
  const auto strays = for_each_frame(text, [&](const LogFrame& frame) {
    out.push_back(to_string(frame));
    return true;
  });
  if (strays.unknown > 0)
    out.push_back("unknown " + std::to_string(strays.unknown) + " at " + std::to_string(strays.first));
  if (strays.unsuited > 0) out.push_back("unsuited " + std::to_string(strays.unsuited));
  return out;
}

TEST(Trc, Version10HasNoVersionInItsHeader) {
  EXPECT_EQ(read_trace(";##########\r\n"
                       ";   C:\\trace.trc\r\n"
                       ";   Start time: 11.09.2002 16:00:20.682\r\n"
                       ";----+-   ---+---  ----+---  +  -+ -- -- ...\r\n"
                       "     1)      1841      0601  8  40 41 60 00 00 00 00 00\r\n"
                       "     2)      1842      0008  4  ERROR 00 19 08 08\r\n"
                       "     3)      1843  FFFFFFFF  4  00 00 00 04 -- -- -- -- BUSLIGHT\r\n"
                       "     4)      1844      0701  1  RTR\r\n"
                       "     5)      1845  00000100  1  AA\r\n"),
            (Frames{"(0000000001.841000) can1 601#4041600000000000",
                    "(0000000001.842000) can1 20000008#0000000000000000", "(0000000001.844000) can1 701#R1",
                    "(0000000001.845000) can1 00000100#AA"}));
}

TEST(Trc, Version11HasTenthsAndATypeAndWarnings) {
  EXPECT_EQ(
      read_trace(";$FILEVERSION=1.1\n"
                 ";$STARTTIME=37704.5364870833\n"
                 "     1)      1059.9  Rx         0300  7  00 00 00 00 04 00 00\n"
                 "     3)      1298.9  Tx         0400  2  00 00\n"
                 "     5)      1346.8  Warng  FFFFFFFF  4  00 00 00 04  BUSLIGHT\n"
                 "     6)      1349.2  Error      0008  4  00 19 08 08\n"
                 "     7)      1352.7  Rx         0100  3  RTR\n"),
      (Frames{"(0000000001.059900) can1 300#00000000040000", "(0000000001.298900) can1 400#0000",
              "(0000000001.349200) can1 20000008#0000000000000000", "(0000000001.352700) can1 100#R3"}));
}

TEST(Trc, Version12HasABusAndVersion13AReservedColumn) {
  EXPECT_EQ(read_trace(";$FILEVERSION=1.2\n"
                       "     1)      1059.900  2  Rx         0300  2  00 01\n"
                       "     7)      1352.743  1  Rx         0100  3  RTR\n"),
            (Frames{"(0000000001.059900) can2 300#0001", "(0000000001.352743) can1 100#R3"}));
  EXPECT_EQ(read_trace(";$FILEVERSION=1.3\n"
                       "     1)      6357.213 1  Rx        0401 -  8    00 01 02 03 04 05 06 07\n"
                       "     2)      1346.834 1  Warng FFFFFFFF -  4    00 00 00 04 BUSLIGHT\n"
                       "     3)      6357.300 1  Rx        0402 -  9    00 01 02 03 04 05 06 07 08\n"),
            (Frames{"(0000000006.357213) can1 401#0001020304050607", "unsuited 1"}));
}

TEST(Trc, Version20TellsItsColumns) {
  EXPECT_EQ(
      read_trace(";$FILEVERSION=2.0\n"
                 ";$STARTTIME=42209.4075997106\n"
                 ";$COLUMNS=N,O,T,I,d,l,D\n"
                 "      1      1059.900 DT     0300 Rx 7  00 00 00 00 04 00 00\n"
                 "      5      1334.416 FD     0500 Tx 12 01 02 03 04 05 06 07 08 09 0A 0B 0C\n"
                 "      6      1334.522 ER          Rx    04 00 02 00 00\n"
                 "      7      1334.531 ST          Rx    00 00 00 08\n"
                 "      8      1334.643 EC          Rx    02 02\n"
                 "      9      1335.156 DT 18EFC034 Tx 2  01 02\n"
                 "     10      1336.543 RR     0100 Rx 3\n"),
      (Frames{"(0000000001.059900) can1 300#00000000040000",
              "(0000000001.334522) can1 20000008#0000000000000000", "(0000000001.335156) can1 18EFC034#0102",
              "(0000000001.336543) can1 100#R3", "unsuited 1"}));
}

TEST(Trc, Version21HasBusesAndLengthCodes) {
  EXPECT_EQ(read_trace(";$FILEVERSION=2.1\n"
                       ";$COLUMNS=N,O,T,B,I,d,R,L,D\n"
                       "      1     17535.400 DT 2  00000100 Tx -  2    00 0A\n"
                       "      2     17540.300 ST 1         - Rx -  4    00 00 00 08\n"
                       "      3     17600.000 DT 1      0601 Rx -  15   01 02 03 04 05 06 07 08\n"
                       "     12     48937.600 RR 1      0704 Rx -  1\n"),
            (Frames{"(0000000017.535400) can2 00000100#000A", "(0000000017.600000) can1 601#0102030405060708",
                    "(0000000048.937600) can1 704#R1"}));
}

TEST(Trc, ALineThatWasCutIsToldAndTheRestIsRead) {
  EXPECT_EQ(read_trace(";$FILEVERSION=1.1\n"
                       "     1)      1059.9  Rx         0300  7  00 00 00\n"
                       "     2)      1060.9  Rx         0800  1  00\n"
                       "     3)      x       Rx         0300  1  00\n"
                       "     4)      1061.9  Rx         0300  1  0G\n"
                       "     5)      1062.9  Rx         0300  1  01\n"
                       "     6)      1063.9  R"),
            (Frames{"(0000000001.062900) can1 300#01", "unknown 4 at 2"}));
}

TEST(Trc, ACandumpLogIsNone) {
  EXPECT_FALSE(is_trc("(1736412345.123456) can0 601#4041600000000000\n;$FILEVERSION=1.1\n"));
  EXPECT_FALSE(is_trc(""));
  EXPECT_FALSE(is_trc("; a comment\n"));
}

}  // namespace
}  // namespace servoctl::can
