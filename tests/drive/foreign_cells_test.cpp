// Numbers, units, ranges, lists, objects and codes in the cells of tables as people have them.
#include <gtest/gtest.h>

#include "drive/foreign_cells.hpp"

namespace servoctl::drive {
namespace {

TEST(ForeignCells, RangesUnitsObjectsAndLists) {
  using Range = std::pair<std::string, std::string>;
  for (const auto* text : {"0~100", "0 - 100", "0..100", "[0, 100]", "0～100", "0 to 100", "0至100"})
    EXPECT_EQ(family_range(text), (Range{"0", "100"})) << text;
  EXPECT_EQ(family_range("-5.5~5.5"), (Range{"-5.5", "5.5"}));
  for (const auto* text : {"", "5", "a~b", "0~", "1~2~3"})
    EXPECT_EQ(family_range(text), std::nullopt) << text;
  EXPECT_EQ(family_range("0,5"), std::nullopt) << "a decimal comma, perhaps";
  EXPECT_EQ(family_unit("0.1r/min"), (Range{"0.1", "rpm"}));
  EXPECT_EQ(family_unit("ms"), (Range{"", "ms"}));
  EXPECT_EQ(family_unit("rad/s2"), (Range{"", "rad/s2"}));
  EXPECT_EQ(family_object("2001h", "1").text, "0x2001:01");
  EXPECT_EQ(family_object("0x2001", "").text, "0x2001:00");
  EXPECT_FALSE(family_object("0x2001", "").has_sub);
  EXPECT_EQ(family_object("2001-0Ah", "").text, "0x2001:0A");
  EXPECT_EQ(family_labels("0：关，1：开"), "0=关;1=开");
  EXPECT_EQ(family_labels("0：关 1：开"), "0=关;1=开");
  EXPECT_EQ(family_labels("0: off,\n1: on"), family_labels("0=off;1=on"));
  EXPECT_EQ(family_labels("0=Out 1 off;1=Out 1 on"), "0=Out 1 off;1=Out 1 on");
  for (const auto* text :
       {"see page 3", "0-1,3-5", "0:100", "0:off1:on", "0: off / 1: on", "1: ratio 1:2", "0:off 1:on A:x"})
    EXPECT_EQ(family_labels(text), std::nullopt) << text;
  EXPECT_EQ(family_labels("0=acc: fast;1=dec: slow"), "0=acc: fast;1=dec: slow");
  EXPECT_EQ(family_object("2003h", "sub2").text, "2003h:sub2") << "no object, and not 2003h";
  EXPECT_EQ(family_range("±100"), (Range{"-100", "100"}));
  EXPECT_EQ(family_range("±-1"), std::nullopt);
  for (const auto* text : {"1/min", "min-1", "r/min"})
    EXPECT_EQ(family_unit(text), (Range{"", "rpm"})) << text;
  EXPECT_EQ(family_unit("0.1 ms/1000rpm"), (Range{"0.1", "ms/1000rpm"}));
  EXPECT_EQ(family_unit("Hz/1000"), std::nullopt);
  for (const auto* text :
       {"2-Jan", "Jan-02", "1月2日", "2026-01-02", "02. Jan", "1/2/2026", "2.00E+05", "2E+05"})
    EXPECT_TRUE(is_changed_by_spreadsheet(text)) << text;
  for (const auto* text : {"P1-02", "1-02", "Marker-2", "2E05", "1.02", "A-1-2000", ""})
    EXPECT_FALSE(is_changed_by_spreadsheet(text)) << text;
  EXPECT_EQ(family_code("2310", true), "0x2310");
  EXPECT_EQ(family_code("2310", false), std::nullopt);
  EXPECT_EQ(family_code("2310h", false), "0x2310");
  EXPECT_EQ(family_code("AL.09", true), std::nullopt);
}

}  // namespace
}  // namespace servoctl::drive
