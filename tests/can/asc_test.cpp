#include "can/asc.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "base/text.hpp"

namespace servoctl::can {
namespace {

using Kind = AscLine::Kind;

/// What became of each line, frames in the notation of candump.
std::vector<std::string> read_all(std::string_view text) {
  AscReader reader;
  std::vector<std::string> out;
  for (const auto row : split(text, '\n')) {
    if (row.empty()) continue;
    const auto line = reader.read(row);
    switch (line.kind) {
      case Kind::frame: out.push_back(to_string(line.frame)); break;
      case Kind::remark: out.emplace_back("remark"); break;
      case Kind::unsuited: out.emplace_back("unsuited"); break;
      case Kind::malformed: out.emplace_back("malformed"); break;
    }
  }
  return out;
}

using Lines = std::vector<std::string>;

TEST(Asc, IsReadAsLog2ascWritesIt) {
  EXPECT_EQ(read_all("date Tue Nov 14 22:13:20 2023\n"
                     "base hex  timestamps absolute\n"
                     "no internal events logged\n"
                     "   0.000000 1  601             Rx   d 8 40 41 60 00 00 00 00 00\n"
                     "   0.100000 1  181             Tx   d 4 37 02 01 02\r\n"
                     "   0.200000 2  701             Rx   r 0\n"
                     "   0.300000 1  123x            Rx   d 1 00\n"),
            (Lines{"remark", "remark", "remark", "(0000000000.000000) can1 601#4041600000000000",
                   "(0000000000.100000) can1 181#37020102", "(0000000000.200000) can2 701#R",
                   "(0000000000.300000) can1 00000123#00"}));
}

TEST(Asc, IsReadAsVectorsToolsWriteIt) {
  EXPECT_EQ(
      read_all(
          "// version 8.5.0\n"
          "Begin Triggerblock Tue Nov 14 10:13:20.000 pm 2023\n"
          "   0.000000 Start of measurement\n"
          "   0.002110 CAN 1 Status:chip status error active\n"
          "   0.010000 1  Statistic: D 0 R 0 XD 0 XR 0 E 0 O 0 B 0.00%\n"
          "   1.000100 1  7E5  Rx   d 8 04 01 00 00 00 00 00 00  Length = 234000 BitCount = 120 ID = 2021\n"
          "   1.000200 1  701  Rx   r\n"
          "   1.000300 1  ErrorFrame  ECC: 10100010\n"
          "   1.000400 1  601  TxRq d 8 00 00 00 00 00 00 00 00\n"
          "   1.000500 CANFD   1 Rx  601  1 0 8 8 00 00 00 00 00 00 00 00 0 0 0 0 0 0 0 0\n"
          "End TriggerBlock\n"),
      (Lines{"remark", "remark", "remark", "remark", "remark",
             "(0000000001.000100) can1 7E5#0401000000000000", "(0000000001.000200) can1 701#R",
             "(0000000001.000300) can1 20000008#0000000000000000", "remark", "unsuited", "remark"}));
}

TEST(Asc, HasItsNumbersInTheBaseOfItsHeader) {
  EXPECT_EQ(read_all("base dec timestamps absolute\n"
                     "0.5 1 1537 Rx d 3 64 65 255\n"
                     "0.6 1 291x Rx d 0\n")
                .at(1),
            "(0000000000.500000) can1 601#4041FF");
}

TEST(Asc, WithRelativeTimesCountsFromTheLineBefore) {
  const auto lines =
      read_all("base hex timestamps relative\n0.1 1 080 Rx d 0\n0.2 Log Trigger event\n0.25 1 080 Rx d 0\n");
  EXPECT_EQ(lines.at(1), "(0000000000.100000) can1 080#");
  EXPECT_EQ(lines.at(3), "(0000000000.550000) can1 080#");
}

TEST(Asc, TellsLinesThatBeginLikeAFrameAndAreNone) {
  for (const auto* text :
       {"0.1 1 601", "0.1 1 801 Rx d 0", "0.1 1 601 Rx d 2 00", "0.1 1 601 Rx d 1 100", "0.1 1 601 Rx q 1 00",
        "1 1 601 Rx d 0", "0.1 1 20000000x Rx d 0", "0.1 1 601 Rx d"})
    EXPECT_EQ(read_all(text), Lines{"malformed"}) << text;
}

TEST(Asc, IsRecognisedByItsHeader) {
  EXPECT_TRUE(is_asc("date Tue Nov 14 22:13:20 2023\nbase hex  timestamps absolute\n"));
  EXPECT_FALSE(is_asc("(1700000000.123456) can0 601#4041600000000000\n"));
  EXPECT_FALSE(is_asc(""));
}

}  // namespace
}  // namespace servoctl::can
