#include "od/dcf.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "od/eds.hpp"

namespace servoctl::od {
namespace {

const std::string kSheet =
    "; a comment\n"
    "[FileInfo]\nFileName=drive.eds\nModificationDate=01-02-2020\nModificationTime=12:00PM\n"
    "[DeviceInfo]\nProductName=Lab drive\n"
    "[DummyUsage]\nDummy0005=1\n"
    "[MandatoryObjects]\nSupportedObjects=1\n1=0x1000\n"
    "[OptionalObjects]\nSupportedObjects=3\n1=0x1400\n2=0x1600\n3=0x6065\n"
    "[ManufacturerObjects]\nSupportedObjects=2\n1=0x2001\n2=0x2002\n"
    "[1000]\nParameterName=Device type\nDataType=0x0007\nAccessType=ro\n"
    "[1400]\nParameterName=RPDO 1\nObjectType=9\nSubNumber=2\n"
    "[1400sub0]\nParameterName=Count\nDataType=5\nAccessType=ro\n"
    "[1400sub1]\nParameterName=COB-ID\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x200\n"
    "[1600]\nParameterName=Mapping\nObjectType=8\nDataType=7\nAccessType=rw\nCompactSubObj=3\n"
    "[6065]\nParameterName=Window\nDataType=4\nAccessType=rw\nParameterValue=7\n"
    "[2001]\nParameterName=Gain\nDataType=8\nAccessType=rw\n"
    "[2002]\nParameterName=Name\nDataType=9\nAccessType=rw\n";

DcfSettings settings() {
  DcfSettings out;
  out.file_name = "axis.dcf";
  out.date = "11-18-2026";
  out.time = "11:06AM";
  out.node_id = 5;
  out.node_name = "Node 5";
  out.kbps = 500;
  out.values = {{{0x1400, 1}, std::uint64_t{0x205}},
                {{0x1600, 1}, std::uint64_t{0x60400010}},
                {{0x1600, 3}, std::uint64_t{0}},
                {{0x6065, 0}, std::int64_t{-40}},
                {{0x2001, 0}, 0.1},
                {{0x2002, 0}, std::string("left = right; #1")}};
  return out;
}

std::string refusal(const std::string& text) {
  const auto dcf = read_dcf(text, "x.dcf");
  if (!dcf) return dcf.error().message.text();
  return dcf->unusable.empty() ? std::string("taken") : dcf->unusable.front().message.text();
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const auto place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  return place == std::string::npos ? text : text.replace(place, from.size(), to);
}

TEST(Dcf, IsTheDataSheetWithValuesAndCommissioning) {
  const auto text = write_dcf(kSheet, settings()).value();
  EXPECT_EQ(text.substr(0, text.find("[MandatoryObjects]")),
            "[FileInfo]\nFileName=axis.dcf\nLastEDS=drive.eds\nModificationDate=11-18-2026\n"
            "ModificationTime=11:06AM\n\n"
            "[DeviceInfo]\nProductName=Lab drive\n\n"
            "[DeviceComissioning]\nNodeID=5\nNodeName=Node 5\nBaudrate=500\nNetNumber=1\nNetworkName=\n"
            "CANopenManager=0\n\n"
            "[DummyUsage]\nDummy0005=1\n\n");
  EXPECT_NE(text.find("DefaultValue=$NODEID+0x200\nParameterValue=517\n"), std::string::npos) << text;
  EXPECT_NE(text.find("[1600Value]\nNrOfEntries=2\n1=1614807056\n3=0\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("ParameterValue=7\n"), std::string::npos) << "the value of the data sheet is replaced";
  EXPECT_EQ(write_dcf(kSheet, settings()).value(), text);
  // One more: 6040h, which the values map, is not in the data sheet.
  EXPECT_EQ(read_eds(text, "axis.dcf")->diagnostics.size(),
            read_eds(kSheet, "drive.eds")->diagnostics.size() + 1);
}

TEST(Dcf, SaysAfterReadingWhatWasWritten) {
  const auto dcf = read_dcf(write_dcf(kSheet, settings()).value(), "axis.dcf").value();
  EXPECT_EQ(dcf.node_id, 5);
  std::map<ObjectAddress, Value> read;
  for (const auto& value : dcf.values) read.emplace(value.object, value.value.for_node(5));
  EXPECT_EQ(read, settings().values);
  EXPECT_EQ(write_dcf(write_dcf(kSheet, settings()).value(), settings()).value().find("LastEDS=drive.eds"),
            std::string::npos)
      << "the data sheet of a DCF made of a DCF is that DCF";
}

TEST(Dcf, OfAnotherToolMayNameTheNodeInItsValues) {
  const auto dcf = read_dcf(replaced(kSheet, "ParameterValue=7",
                                     "ParameterValue=0xFFFFFFF0\n[DeviceComissioning]\nNodeID=0x21"),
                            "x.dcf")
                       .value();
  EXPECT_EQ(dcf.node_id, 0x21);
  ASSERT_EQ(dcf.values.size(), 1U);
  EXPECT_EQ(dcf.values[0].value.value, Value(std::int64_t{-16}));
  const auto formula =
      read_dcf(replaced(kSheet, "DefaultValue=$NODEID+0x200", "ParameterValue=$NODEID+0x200"), "x.dcf");
  EXPECT_EQ(formula->values.at(0).value.for_node(9), Value(std::uint64_t{0x209}));
  EXPECT_EQ(formula->values.at(0).line, 38U);
}

TEST(Dcf, NeverLosesAValueSilently) {
  const auto with = [](std::string_view from, std::string_view to) { return replaced(kSheet, from, to); };
  EXPECT_EQ(refusal(kSheet), "taken");
  EXPECT_EQ(refusal(with("ParameterValue=7", "ParameterValue=seven")),
            "x.dcf:49: ParameterValue: 'seven' is not a number");
  EXPECT_EQ(refusal(with("ParameterValue=7", "ParameterValue=0x1FFFFFFFF")),
            "x.dcf:49: ParameterValue: 0x1FFFFFFFF does not fit i32 (-2147483648..2147483647)");
  EXPECT_EQ(refusal(with("ParameterValue=7", "ParameterValue=7\nParameterValue=8")),
            "x.dcf:50: [6065] has a second ParameterValue");
  EXPECT_EQ(refusal(with("DataType=4\nAccessType=rw\n", "AccessType=rw\n")).substr(0, 9), "x.dcf:45:");
  EXPECT_EQ(refusal(kSheet + "[6065]\nParameterValue=9\n"),
            "x.dcf:58: [6065] appears again, first in line 45; the first one is used");
  EXPECT_EQ(refusal(kSheet + "[Elsewhere]\nParameterValue=9\n"),
            "x.dcf:59: [Elsewhere] describes no object that could hold the value");
  EXPECT_EQ(refusal(kSheet + "[1600Value]\n4=9\n"),
            "x.dcf:59: [1600Value] describes no object that could hold the value");
  EXPECT_EQ(refusal(kSheet + "[1600Value]\n1=9\n01=8\n"), "x.dcf:60: [1600Value] has a second entry 1");
  EXPECT_EQ(refusal(kSheet + "[1600Value]\none=9\n"), "x.dcf:59: [1600Value] has no entry 'one'");
  EXPECT_EQ(refusal(with("ParameterValue=7\n", "")), "x.dcf: it contains no ParameterValue");
}

/// Entries of an array, each with its own section, or as a compact list.
std::string entries(std::string_view main, std::string_view first, std::string_view list) {
  return fmt::format(
      "[2100]\nParameterName=A\nObjectType=8\nSubNumber=3\n{}[2100sub0]\nParameterName=n\nDataType=5\n"
      "AccessType=ro\n[2100sub1]\nParameterName=a\nDataType=6\nAccessType=rw\n{}[2100sub2]\nParameterName=b\n"
      "DataType=6\nAccessType=rw\n{}",
      main, first, list);
}

TEST(Dcf, PassesOverTheValueOfAWholeRecordAndTellsIt) {
  const auto dcf = read_dcf(entries("ParameterValue=9\n", "ParameterValue=1\n", ""), "x.dcf").value();
  EXPECT_TRUE(dcf.unusable.empty());
  ASSERT_EQ(dcf.values.size(), 1U);
  EXPECT_EQ(dcf.values[0].object, (ObjectAddress{0x2100, 1}));
  ASSERT_EQ(dcf.passed_over.size(), 1U);
  EXPECT_EQ(dcf.passed_over[0], "x.dcf:5: [2100] has sub-indexes and holds no value of its own");
}

TEST(Dcf, TakesAListOfValuesBesideExplicitSubIndexes) {
  const auto dcf = read_dcf(entries("", "", "[2100Value]\nNrOfEntries=2\n1=5\n2=0x10\n"), "x.dcf").value();
  EXPECT_TRUE(dcf.unusable.empty() && dcf.passed_over.empty());
  ASSERT_EQ(dcf.values.size(), 2U);
  EXPECT_EQ(to_string(dcf.values[0].value.value), "5");
  EXPECT_EQ(to_string(dcf.values[1].value.value), "16");
  const auto both =
      read_dcf(entries("", "ParameterValue=7\n", "[2100Value]\n1=5\n2=6\n3=1\n"), "x.dcf").value();
  ASSERT_EQ(both.values.size(), 2U);
  EXPECT_EQ(to_string(both.values[0].value.value), "7") << "its own goes before that of the list";
  EXPECT_EQ(both.passed_over.size(), 1U);
  ASSERT_EQ(both.unusable.size(), 1U) << "there is no sub-index 3";
  const auto wrong = read_dcf(entries("", "", "[2100Value]\n1=five\n2=6\n"), "x.dcf").value();
  EXPECT_EQ(wrong.values.size(), 1U);
  EXPECT_EQ(wrong.unusable.size(), 1U);
}

}  // namespace
}  // namespace servoctl::od
