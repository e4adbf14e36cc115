// SlcanLines and flags are those of the CAN232 manual (version 3) and of drivers/net/can/slcan/slcan-core.c
// of Linux.
#include "can/slcan_codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "can/controller_report.hpp"
#include "can/error_frame.hpp"

namespace servoctl::can {
namespace {

using LineKind = SlcanLine::Kind;

/// What the bytes become: frames in the notation of candump, other lines by a word.
std::vector<std::string> slcan_lines(std::string_view bytes, std::size_t piece = 0) {
  SlcanReader reader;
  if (piece == 0) piece = bytes.size() + 1;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(piece, bytes.size())))
    reader.put(bytes.substr(0, piece));
  std::vector<std::string> out;
  while (const auto line = reader.take()) {
    switch (line->kind) {
      case LineKind::acknowledged: out.emplace_back("ok"); break;
      case LineKind::refused: out.emplace_back("refused"); break;
      case LineKind::frame:
        out.push_back(to_string(line->frame) + (line->stamp ? "@" + std::to_string(*line->stamp) : ""));
        break;
      case LineKind::flags: out.push_back("flags " + std::to_string(line->flags)); break;
      case LineKind::report: out.push_back("report " + to_string(line->frame)); break;
      case LineKind::text: out.push_back("text " + line->text); break;
      case LineKind::damaged: out.emplace_back("damaged"); break;
    }
  }
  return out;
}

using SlcanLines = std::vector<std::string>;

Frame frame_from(const char* text) { return parse_frame(text).value(); }

TEST(SlcanCodec, ReadsFramesOfAllKinds) {
  EXPECT_EQ(slcan_lines("t1230\rt4563112233\rT12ABCDEF2AA55\rr1230\rr7011\rR000000018\r"),
            (SlcanLines{"123#", "456#112233", "12ABCDEF#AA55", "123#R", "701#R1", "00000001#R8"}));
}

TEST(SlcanCodec, ReadsSmallDigitsToo) { EXPECT_EQ(slcan_lines("t7ff1ab\r"), (SlcanLines{"7FF#AB"})); }

TEST(SlcanCodec, WritesFramesOfAllKinds) {
  EXPECT_EQ(slcan_line(frame_from("456#112233")), "t4563112233\r");
  EXPECT_EQ(slcan_line(frame_from("123#")), "t1230\r");
  EXPECT_EQ(slcan_line(frame_from("12ABCDEF#AA55")), "T12ABCDEF2AA55\r");
  EXPECT_EQ(slcan_line(frame_from("701#R1")), "r7011\r");
  EXPECT_EQ(slcan_line(frame_from("00000001#R8")), "R000000018\r");
}

TEST(SlcanCodec, TakesStampsOfAMinute) {
  EXPECT_EQ(slcan_lines("t60120102EA5F\rt60100000\r"), (SlcanLines{"601#0102@59999", "601#@0"}));
  EXPECT_EQ(slcan_lines("r70110010\r"), (SlcanLines{"701#R1@16"}));
}

TEST(SlcanCodec, AFrameThatDiffersInItsStampHasLostDigitsUnlessOthersFollow) {
  EXPECT_EQ(slcan_lines("t60140102030400FF\rt60140102FF03\rt60140102030400FF\r"),
            (SlcanLines{"601#01020304@255", "damaged", "601#01020304@255"}));
  // The first one was damaged: a length of 8 that became 6.
  EXPECT_EQ(slcan_lines("t60161122334455660708\rt6011AA\rt6011BB\rt6011CC\rt6011DD\r"),
            (SlcanLines{"601#112233445566@1800", "damaged", "damaged", "601#CC", "601#DD"}));
}

TEST(SlcanCodec, KnowsAnswersApart) {
  EXPECT_EQ(slcan_lines("\rz\rZ\r\aV1013\rNA123\rF24\r"),
            (SlcanLines{"ok", "ok", "ok", "refused", "text V1013", "text NA123", "flags 36"}));
}

TEST(SlcanCodec, LinesEndInAnyWay) {
  EXPECT_EQ(slcan_lines("t1230\r\nt1231AA\n\r\nz\r\n"), (SlcanLines{"123#", "123#AA", "ok", "ok"}));
}

TEST(SlcanCodec, LinesAreTheSameHoweverTheyAreCut) {
  const std::string all = "t6018404160000000000\rt60184041600000000000\r\n\aV1013\rT12ABCDEF2AA55\r\nF00\r\r";
  for (std::size_t piece = 1; piece < all.size(); ++piece)
    EXPECT_EQ(slcan_lines(all, piece), slcan_lines(all)) << piece;
}

TEST(SlcanCodec, ALineThatLostOneByteIsNoFrame) {
  const std::string whole = "t60184041600000000000\r";
  for (std::size_t at = 0; at + 1 < whole.size(); ++at) {
    auto line = whole;
    line.erase(at, 1);
    for (const auto& got : slcan_lines(line)) EXPECT_EQ(got.find('#'), std::string::npos) << line;
  }
}

TEST(SlcanCodec, ALostEndSpoilsTwoLinesAndNoMore) {
  EXPECT_EQ(slcan_lines("t6011AAt6011BB\rt6011CC\r"), (SlcanLines{"damaged", "601#CC"}));
  EXPECT_EQ(slcan_lines("t6011A\at6011CC\r"), (SlcanLines{"damaged", "refused", "601#CC"}));
}

TEST(SlcanCodec, WhatIsOutOfRangeIsNoFrame) {
  for (const char* line : {"t8000\r", "t1239112233445566778899\r", "T200000000\r", "t123\r", "t\r",
                           "t12312\r", "tx230\r", "t1231+1\r", "t123-\r", "t1231 A\r"})
    EXPECT_EQ(slcan_lines(line), (SlcanLines{"damaged"})) << line;
}

TEST(SlcanCodec, ALineWithoutEndIsLeftOutUpToItsEnd) {
  EXPECT_EQ(slcan_lines(std::string(100'000, 't') + "\rt1230\r"), (SlcanLines{"damaged", "123#"}));
}

TEST(SlcanCodec, HasTheNineBitratesOfTheProtocol) {
  EXPECT_EQ(slcan_bitrate_digit(10'000), '0');
  EXPECT_EQ(slcan_bitrate_digit(125'000), '4');
  EXPECT_EQ(slcan_bitrate_digit(500'000), '6');
  EXPECT_EQ(slcan_bitrate_digit(1'000'000), '8');
  EXPECT_EQ(slcan_bitrate_digit(83'000), std::nullopt);
  EXPECT_EQ(slcan_bitrate_digit(750'000), std::nullopt);
}

std::vector<std::optional<ControllerReport>> reports_of(std::uint8_t flags) {
  std::vector<std::optional<ControllerReport>> out;
  for (const auto& frame : slcan_reports(flags)) out.push_back(parse_report(frame));
  return out;
}

TEST(SlcanCodec, FlagsBecomeReportsOfTheController) {
  using Reports = std::vector<std::optional<ControllerReport>>;
  EXPECT_EQ(reports_of(0x00), Reports{});
  EXPECT_EQ(reports_of(0x01), (Reports{ControllerReport::overflow}));
  EXPECT_EQ(reports_of(0x02), Reports{}) << "a full transmit queue is told by the refusal of a frame";
  EXPECT_EQ(reports_of(0x04), (Reports{ControllerReport::error_warning}));
  EXPECT_EQ(reports_of(0x08), (Reports{ControllerReport::overflow}));
  EXPECT_EQ(reports_of(0x24), (Reports{ControllerReport::error_passive}));
  EXPECT_EQ(reports_of(0x40), Reports{}) << "lost arbitration is no error";
  ASSERT_EQ(slcan_reports(0x80).size(), 1U);
  EXPECT_EQ(parse_wire_error(slcan_reports(0x80).front()), WireError::other);
}

TEST(SlcanCodec, ReadsWhatAControllerReportsByItself) {
  const auto report = [](const char* line) {
    SlcanReader reader;
    reader.put(line);
    const auto read = reader.take();
    return read && read->kind == LineKind::report ? std::optional(read->frame) : std::nullopt;
  };
  EXPECT_EQ(parse_report(report("sb256256\r").value()), ControllerReport::bus_off);
  EXPECT_EQ(parse_report(report("sa057033\r").value()), ControllerReport::error_active);
  EXPECT_EQ(parse_report(report("sp000128\r").value()), ControllerReport::error_passive);
  EXPECT_EQ(parse_report(report("sw100000\r").value()), ControllerReport::error_warning);
  EXPECT_EQ(report("sa057033\r")->data[6], 33) << "the counter of sent frames";
  EXPECT_EQ(report("sa057033\r")->data[7], 57);
  EXPECT_EQ(parse_wire_error(report("e1a\r").value()), WireError::acknowledge);
  EXPECT_EQ(parse_wire_error(report("e1s\r").value()), WireError::stuff);
  EXPECT_EQ(parse_wire_error(report("e1c\r").value()), WireError::checksum);
  EXPECT_EQ(parse_wire_error(report("e3bcO\r").value()), WireError::dominant);
  EXPECT_EQ(parse_report(report("e1o\r").value()), ControllerReport::overflow);
  for (const char* text : {"sx000000\r", "sa12\r", "e2a\r", "e1x\r", "e\r"})
    EXPECT_EQ(report(text), std::nullopt) << text;
}

}  // namespace
}  // namespace servoctl::can
