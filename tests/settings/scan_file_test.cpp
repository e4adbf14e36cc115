// What a scan keeps of its work.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "settings/scan_file.hpp"
#include "settings/scan_ranges.hpp"

namespace servoctl::settings {
namespace {

session::ScanState sample_scan() {
  session::ScanState state{.ranges = {{0x2000, 0x2FFF}, {0x6000, 0x67FF}}, .done = 77};
  state.entries = {{{0x2000, 0}, true, 2, {1, 2}},
                   {{0x2000, 0xFE}, false},
                   {{0x2001, 0}, true, 0, {}},
                   {{0x2002, 0}, true, 400, Bytes(session::kScannedBytes, 0xAB)}};
  state.refusals = {{{0x2003, 0}, 0x0800'0022}, {{0x2004, 1}, 0}};
  return state;
}

TEST(ScanFile, ReadsWhatItWrites) {
  const auto state = sample_scan();
  const auto read = read_scan(scan_text("00020192 - - - -", state));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->identity, "00020192 - - - -");
  EXPECT_EQ(read->state.ranges, state.ranges);
  EXPECT_EQ(read->state.done, state.done);
  EXPECT_EQ(read->state.entries, state.entries);
  EXPECT_EQ(read->state.refusals, state.refusals);
}

TEST(ScanFile, WhatIsCutOrContradictsItselfIsNotRead) {
  const auto text = scan_text("x", sample_scan());
  for (std::size_t size = 0; size + 1 < text.size(); ++size)
    EXPECT_FALSE(read_scan(std::string_view(text).substr(0, size))) << size;
  auto lost = text;
  lost.erase(lost.find("2001:0"), lost.find("2002:0") - lost.find("2001:0"));
  EXPECT_FALSE(read_scan(lost)) << "a line less than it says";
  auto twice = sample_scan();
  twice.entries.push_back(twice.entries.front());
  EXPECT_FALSE(read_scan(scan_text("x", twice)));
  auto ahead = sample_scan();
  ahead.entries.push_back({{0x2500, 0}, false});
  EXPECT_FALSE(read_scan(scan_text("x", ahead))) << "that index is not done";
}

TEST(ScanFile, RangesAreInOrderAndNoneTwice) {
  EXPECT_EQ(ranges_text(parse_ranges("6000-67FF, 2000-2fff,1018").value()), "1018-1018,2000-2FFF,6000-67FF");
  EXPECT_EQ(ranges_text(parse_ranges("0x2000-2010h").value()), "2000-2010");
  EXPECT_NE(parse_ranges("2000-2010,").error().message.text().find("comma"), std::string::npos);
  std::string many = "2000";
  for (int i = 1; i < 16; ++i) many += fmt::format(",20{:02X}", i);
  EXPECT_TRUE(parse_ranges(many));
  EXPECT_FALSE(parse_ranges(many + ",2010"));
  for (const auto* wrong : {"", "0FFF-2000", "2000-1FFF", "9000-A000", "2000-2FFF,2FFF-3000", "abc-xyz"})
    EXPECT_FALSE(parse_ranges(wrong)) << wrong;
}

}  // namespace
}  // namespace servoctl::settings
