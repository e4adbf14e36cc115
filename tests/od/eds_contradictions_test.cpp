// Data sheets whose parts contradict each other.
#include "od/dcf.hpp"
#include "tests/od/eds_support.hpp"

namespace servoctl::od {
namespace {

TEST(EdsList, WithAnObjectTwiceOrInTheWrongListIsTold) {
  const auto objects = variable("1000", "7", "") + variable("2000", "7", "") + variable("6000", "7", "");
  const auto with = [&](const std::string& lists) { return findings(read(lists + objects)); };
  EXPECT_EQ(
      with("[MandatoryObjects]\n1=0x1000\n[OptionalObjects]\n1=0x6000\n[ManufacturerObjects]\n1=0x2000\n"),
      Rules{});
  EXPECT_EQ(with("[OptionalObjects]\n1=0x1000\n2=0x2000\n[ManufacturerObjects]\n1=0x6000\n"),
            (Rules{"2:3 wrong-list", "3:3 wrong-list", "5:3 wrong-list"}));
  EXPECT_EQ(
      with("[MandatoryObjects]\n1=0x1000\n2=0x1000\n[OptionalObjects]\n1=0x6000\n[ManufacturerObjects]\n"
           "1=0x2000\n2=0x2000\n"),
      (Rules{"3:3 listed-twice", "8:3 listed-twice"}));
  const auto file = read("[OptionalObjects]\n1=0x2000\n" + variable("2000", "7", ""));
  EXPECT_EQ(file.diagnostics.front().message,
            "0x2000 is in OptionalObjects but belongs in ManufacturerObjects");
}

/// A TPDO that maps this, by default, beside 2000h (u16), 2001h (bool) and 2002h (string).
EdsFile mapped(const std::string& first, const std::string& second = "0") {
  return read("[1800]\nParameterName=C\nObjectType=9\nSubNumber=1\n" + variable("1800sub0", "5", "") +
              "[1A00]\nParameterName=M\nObjectType=9\nSubNumber=3\n" +
              variable("1A00sub0", "5", "DefaultValue=2") +
              variable("1A00sub1", "7", "DefaultValue=" + first) +
              variable("1A00sub2", "7", "DefaultValue=" + second) + variable("2000", "6", "") +
              variable("2001", "1", "") + variable("2002", "9", ""));
}

TEST(EdsMapping, FitsTheObjectsOfTheFile) {
  for (const auto* good : {"0x20000010", "0x20010001", "0x20010008", "0x20020040", "0x00050008", "0"})
    EXPECT_EQ(findings(mapped(good)), Rules{}) << good;
  EXPECT_EQ(findings(mapped("0x20000008")), Rules{"19:1 mapping-length"});
  EXPECT_EQ(mapped("0x20000008").diagnostics.front().message,
            "DefaultValue: 0x1A00:1 maps 8 bits of 0x2000:0, which is u16 (16 bits)");
  EXPECT_EQ(findings(mapped("0x00050010")), Rules{"19:1 mapping-length"});
  EXPECT_EQ(findings(mapped("0x30000010")), Rules{"19:1 mapping-absent"});
  EXPECT_EQ(findings(mapped("0x20000110")), Rules{"19:1 mapping-absent"});
  EXPECT_EQ(findings(mapped("0x20020040", "0x20000010")), Rules{"14:1 mapping-too-long"});
}

TEST(EdsMapping, OfADcfIsCheckedAsConfigured) {
  const auto file =
      read("[1600]\nParameterName=M\nObjectType=9\nSubNumber=2\n" + variable("1600sub0", "5", "") +
           variable("1600sub1", "7", "ParameterValue=0x30000010"));
  EXPECT_EQ(findings(file), Rules{"10:1 mapping-absent"});
  EXPECT_EQ(file.diagnostics.front().message.substr(0, 15), "ParameterValue:");
}

TEST(EdsNodeIdSum, ThatNoNodeFitsIsTold) {
  const auto file = read(variable("2000", "5", "DefaultValue=$NODEID+0xFF"));
  EXPECT_EQ(findings(file), Rules{"5:14 node-id-sum"});
  EXPECT_EQ(default_of(file, {0x2000, 0}), "none");
  EXPECT_EQ(findings(read(variable("2000", "5", "DefaultValue=$NODEID+0xFE"))), Rules{});
  EXPECT_EQ(findings(read(variable("2000", "0x1B", "DefaultValue=$NODEID+0xFFFFFFFFFFFFFFFF"))),
            Rules{"5:14 node-id-sum"});
  const auto can_id = [](const char* value) {
    return findings(read("[1800]\nParameterName=P\nObjectType=9\nSubNumber=1\n" +
                         variable("1800sub1", "7", "DefaultValue=" + std::string(value))));
  };
  EXPECT_EQ(can_id("$NODEID+0x40000180"), Rules{});
  EXPECT_EQ(can_id("$NODEID+0x7FF"), Rules{"9:14 node-id-sum"});
  EXPECT_EQ(can_id("$NODEID+0x200007FF"), Rules{});
  EXPECT_EQ(read_dcf(variable("2000", "5", "ParameterValue=$NODEID+0xFF"), "x.dcf")->unusable.size(), 1U);
}

TEST(EdsValue, WithALeadingZeroTellsBothReadings) {
  const auto message = [](const char* value) {
    return read(variable("2000", "7", "DefaultValue=" + std::string(value))).diagnostics.at(0).message;
  };
  EXPECT_EQ(message("0777"),
            "'0777' is taken as decimal, 777; by the standard a leading zero means octal: 511");
  EXPECT_EQ(message("007"),
            "'007' is taken as decimal, 7; by the standard a leading zero means octal: the same");
  EXPECT_EQ(message("0089"),
            "'0089' is taken as decimal, 89; by the standard a leading zero means octal: no number");
}

TEST(Dcf, RefusesAParameterValueThatIsTwoNumbers) {
  const auto with = [](const char* value) {
    return read_dcf(variable("2000", "7", "ParameterValue=" + std::string(value)), "x.dcf");
  };
  const auto octal = with("0777");
  ASSERT_EQ(octal->unusable.size(), 1U);
  EXPECT_EQ(
      octal->unusable[0].message,
      "x.dcf:5: ParameterValue: '0777' is 511 by the standard (a leading zero means octal), and 777 to most "
      "who write it; not taken");
  EXPECT_EQ(octal->unusable[0].hint, "write 0x1FF or 777");
  for (const auto* value : {"007", "0", "00", "0x0777"}) EXPECT_TRUE(with(value)->unusable.empty()) << value;
  EXPECT_EQ(read_dcf(variable("2000", "7", "ObjectType=8\nCompactSubObj=1") + "[2000Value]\n1=010\n", "x.dcf")
                ->unusable.size(),
            1U);
}

TEST(EdsSection, OfAVendorIsNoOffence) {
  const auto file = read("[GeneralSettings]\nLanguage=1\n[Vendor Tool 7]\nParameterName=x\n[Resources]\n" +
                         variable("2000", "7", ""));
  EXPECT_EQ(findings(file), Rules{});
  EXPECT_EQ(
      findings(read("[Speed]\nParameterName=S\nDataType=6\nAccessType=rw\n" + variable("2000", "7", ""))),
      Rules{"1:1 unknown-section"});
}

TEST(EdsText, MayHaveHeadings) {
  const auto file =
      read("=====\n===== Device =====\n=======\n*****\n----------\n" + variable("2000", "7", "=========="));
  EXPECT_EQ(findings(file), Rules{});
  EXPECT_EQ(findings(read("=======\n" + variable("2000", "7", "<<<<<<< mine"))),
            (Rules{"1:1 merge-marker", "6:1 merge-marker"}));
}

TEST(EdsFinding, NamesItsSectionAndKey) {
  const auto file =
      read("stray\n" + variable("2000", "5", "LowLimit=-1") + "[2001]\nParameterName=Y\nAccessType=ro\n");
  ASSERT_EQ(file.diagnostics.size(), 3U);
  EXPECT_EQ(file.diagnostics[0].section, "");
  EXPECT_EQ(file.diagnostics[1].section, "2000");
  EXPECT_EQ(file.diagnostics[1].key, "LowLimit");
  EXPECT_EQ(file.diagnostics[2].section, "2001");
  EXPECT_EQ(file.diagnostics[2].key, "");
}

}  // namespace
}  // namespace servoctl::od
