// What other people's files have been seen to hold: taken where the meaning is plain, told either way.
#include "od/dcf.hpp"

#include <algorithm>
#include "tests/od/eds_support.hpp"

namespace servoctl::od {
namespace {

/// A record with sub 0, which says `highest`, and sub-indexes of these names.
EdsFile record(const char* highest, const std::vector<std::string>& subs) {
  std::string text = "[2000]\nParameterName=X\nObjectType=9\nSubNumber=" + std::to_string(subs.size() + 1) +
                     "\n[2000sub0]\nParameterName=N\nDataType=5\nAccessType=ro\nDefaultValue=" + highest +
                     "\n";
  for (const auto& sub : subs) text += variable("2000sub" + sub, "5", "");
  return read(text);
}

std::vector<std::string> rules(const EdsFile& file) {
  std::vector<std::string> out;
  for (const auto& d : file.diagnostics) out.push_back(d.rule);
  return out;
}

TEST(EdsSubIndex, IsDecimalWhenSub0SaysSo) {
  for (const auto* highest : {"0x10", "16"}) {
    const auto file = record(highest, numbers(1, 16));
    EXPECT_EQ(rules(file), Rules{"decimal-sub-index"});
    EXPECT_EQ(file.diagnostics.front().message,
              "the sub-indexes of 2000 are taken as decimal: as sub 0 says");
    EXPECT_NE(file.dictionary.find({0x2000, 10}), nullptr);
    EXPECT_EQ(file.dictionary.find({0x2000, 0x16}), nullptr);
  }
  // A gap, which alone would speak for hexadecimal.
  const auto gap = record("12", {"1", "2", "10", "11", "12"});
  EXPECT_EQ(rules(gap), Rules{"decimal-sub-index"});
  EXPECT_NE(gap.dictionary.find({0x2000, 12}), nullptr);
}

TEST(EdsSubIndex, IsHexadecimalWhenSub0SaysSo) {
  const auto file = record("0x10", numbers(1, 10));
  EXPECT_EQ(rules(file), Rules{"hexadecimal-sub-index"});
  EXPECT_NE(file.dictionary.find({0x2000, 0x10}), nullptr);
  EXPECT_EQ(file.dictionary.find({0x2000, 10}), nullptr);
  EXPECT_EQ(rules(record("0x10", {"1", "10"})), Rules{});
}

TEST(EdsType, OfARecordIsADomainAndNamed) {
  const std::pair<const char*, const char*> types[] = {{"0x0020", "PDO_COMMUNICATION_PARAMETER (0020h)"},
                                                       {"0x0021", "PDO_MAPPING (0021h)"},
                                                       {"0x0022", "SDO_PARAMETER (0022h)"},
                                                       {"0x0023", "IDENTITY (0023h)"},
                                                       {"0x0040", "type of the manufacturer (0040h)"},
                                                       {"0x00A0", "type of the device profile (00A0h)"}};
  for (const auto& type : types) {
    const auto file = read(variable("2000", type.first, "DefaultValue=1"));
    EXPECT_EQ(findings(file), Rules{}) << type.first;
    ASSERT_NE(file.dictionary.find({0x2000, 0}), nullptr) << type.first;
    EXPECT_EQ(file.dictionary.find({0x2000, 0})->type, DataType::domain);
    EXPECT_EQ(file.dictionary.find({0x2000, 0})->note, type.second);
  }
}

/// The type 00A0h as CANFestival writes it: u8 of 1 to 100.
std::string limited_type(const std::string& index) {
  return "[" + index + "]\nParameterName=UNSIGNED8[1-100]\nObjectType=0x9\nSubNumber=4\n" +
         variable(index + "sub0", "5", "DefaultValue=3") + variable(index + "sub1", "5", "DefaultValue=5") +
         variable(index + "sub2", "5", "DefaultValue=1") + variable(index + "sub3", "5", "DefaultValue=100");
}

TEST(EdsType, WithLimitsIsTakenFromItsDefinition) {
  for (const auto* index : {"A0", "00A0"}) {
    const auto file = read(limited_type(index) + variable("2000", "0xA0", "DefaultValue=7") +
                           variable("2001", "0x00A0", "HighLimit=50") + variable("2002", "0xA1", ""));
    EXPECT_EQ(findings(file), Rules{}) << index;
    const auto* entry = file.dictionary.find({0x2000, 0});
    ASSERT_NE(entry, nullptr);
    EXPECT_EQ(entry->type, DataType::u8);
    EXPECT_EQ(default_of(file, {0x2000, 0}), "7");
    EXPECT_EQ(to_string(entry->low->value), "1");
    EXPECT_EQ(to_string(entry->high->value), "100");
    EXPECT_EQ(entry->note, "type 00A0h of the data sheet: u8, 1..100");
    EXPECT_EQ(to_string(file.dictionary.find({0x2001, 0})->high->value), "50");
    EXPECT_EQ(file.dictionary.find({0x2002, 0})->type, DataType::domain);
  }
}

TEST(EdsType, WithLimitsHoldsForCompactSubIndexes) {
  const auto file = read(limited_type("A0") + variable("2000", "0xA0", "ObjectType=8\nCompactSubObj=2"));
  ASSERT_NE(file.dictionary.find({0x2000, 2}), nullptr);
  EXPECT_EQ(file.dictionary.find({0x2000, 2})->type, DataType::u8);
  EXPECT_EQ(to_string(file.dictionary.find({0x2000, 2})->high->value), "100");
}

TEST(EdsCompact, Of255IsClampedWithAWarning) {
  const auto file = read(variable("2000", "5", "ObjectType=8\nCompactSubObj=255"));
  EXPECT_EQ(findings(file), Rules{"6:15 compact-too-many"});
  EXPECT_EQ(file.dictionary.object(0x2000)->entries.size(), 255U);
  EXPECT_EQ(file.dictionary.find({0x2000, 255}), nullptr);
  EXPECT_EQ(rules(read(variable("2000", "5", "ObjectType=8\nCompactSubObj=256") + variable("2001", "5", ""))),
            Rules{"bad-number"});
}

TEST(EdsLimits, OutsideTheTypeAreAWarningAndNoLimit) {
  const auto file = read(variable("2000", "5", "LowLimit=-1\nHighLimit=0xFFFF\nDefaultValue=7"));
  EXPECT_EQ(findings(file), (Rules{"5:10 limit-outside-type", "6:11 limit-outside-type"}));
  EXPECT_EQ(file.error_count(), 0U);
  EXPECT_EQ(file.diagnostics[1].message, "HighLimit: 0xFFFF does not fit u8 (0..255); no limit is taken");
  EXPECT_FALSE(file.dictionary.find({0x2000, 0})->low);
  EXPECT_FALSE(file.dictionary.find({0x2000, 0})->high);
  EXPECT_EQ(default_of(file, {0x2000, 0}), "7");
  EXPECT_EQ(findings(read(variable("2000", "5", "LowLimit=low"))), Rules{"5:10 bad-value"});
  EXPECT_EQ(findings(read(variable("2000", "5", "DefaultValue=256"))), Rules{"5:14 bad-value"});
}

TEST(EdsKey, ThatIsMisspeltIsTakenForWhatItMeans) {
  const auto file = read(
      "[2000]\nParamterName=X\nObjectTyp=7\nDateType=6\nAccesType=rw\nDefaultVaule=9\nLowLimt=1\nPDOMaping="
      "1\n");
  EXPECT_EQ(rules(file), Rules(7, "misspelt-key"));
  const auto* entry = file.dictionary.find({0x2000, 0});
  ASSERT_NE(entry, nullptr);
  EXPECT_EQ(entry->name, "X");
  EXPECT_EQ(entry->type, DataType::u16);
  EXPECT_EQ(entry->access, Access::rw);
  EXPECT_EQ(default_of(file, {0x2000, 0}), "9");
  EXPECT_EQ(to_string(entry->low->value), "1");
  EXPECT_EQ(entry->pdo, PdoMapping::both);
  EXPECT_EQ(file.diagnostics[4].message, "[2000] DefaultVaule is taken as DefaultValue");
  EXPECT_EQ(file.diagnostics[4].remedy, "write DefaultValue");
}

TEST(EdsKey, ThatIsMisspeltBesideTheRightOneIsPassedOver) {
  const auto file = read(variable("2000", "7", "DefaultValue=1\nDefaultVaule=2"));
  EXPECT_EQ(findings(file), Rules{"6:14 misspelt-key"});
  EXPECT_EQ(default_of(file, {0x2000, 0}), "1");
}

TEST(EdsKey, OfAVendorIsNoOffence) {
  const auto file = read("[DeviceInfo]\nVendorText=a\nProductName2=b\n" +
                         variable("2000", "7", "DefaultValue2=5\nUnit=mm\nHelp=x\nMin=1\nHighestValue=3"));
  EXPECT_EQ(findings(file), Rules{});
}

TEST(EdsKey, OfTheDeviceIsTakenForWhatItMeans) {
  const auto file =
      read("[DeviceInfo]\nVendorNmae=A\n[DeviceComissioning]\nNode_ID=7\n" + variable("2000", "7", ""));
  EXPECT_EQ(findings(file), (Rules{"2:12 misspelt-key", "4:9 misspelt-key"}));
  EXPECT_EQ(file.device.vendor_name, "A");
  EXPECT_EQ(file.node_id, 7);
}

TEST(Dcf, TakesAMisspeltParameterValueAndRefusesTwo) {
  const auto text = variable("2000", "7", "ParameterVaule=5");
  const auto dcf = read_dcf(text, "x.dcf");
  ASSERT_TRUE(dcf);
  ASSERT_EQ(dcf->values.size(), 1U);
  EXPECT_EQ(to_string(dcf->values[0].value.value), "5");
  const auto two = read_dcf(text + "ParameterValue=6\n", "x.dcf");
  ASSERT_EQ(two->unusable.size(), 1U);
  EXPECT_EQ(two->unusable[0].message, "x.dcf:6: [2000] has a second ParameterValue");
}

TEST(EdsObject, ThatIsAVarAndHasSubIndexesIsTold) {
  const auto file = read("[2000]\nParameterName=X\nObjectType=7\nDataType=5\nAccessType=ro\nSubNumber=2\n" +
                         variable("2000sub0", "5", "DefaultValue=1") + variable("2000sub1", "5", ""));
  EXPECT_EQ(findings(file), Rules{"3:12 var-with-sub-indexes"});
  EXPECT_EQ(file.dictionary.object(0x2000)->entries.size(), 2U);
}

TEST(EdsSub0, IsU8AndSaysTheHighestSubIndex) {
  const auto with = [](const char* type, const std::string& more, const char* index = "2000") {
    const auto name = std::string(index);
    return findings(read("[" + name + "]\nParameterName=X\nObjectType=9\nSubNumber=3\n[" + name +
                         "sub0]\nParameterName=N\nDataType=" + type + "\n" + more + "\n" +
                         variable(name + "sub1", "7", "") + variable(name + "sub2", "7", "")));
  };
  EXPECT_EQ(with("5", "AccessType=ro\nDefaultValue=2"), Rules{});
  EXPECT_EQ(with("5", "AccessType=ro"), Rules{});
  EXPECT_EQ(with("7", "AccessType=ro\nDefaultValue=2"), Rules{"7:10 sub-0-type"});
  EXPECT_EQ(with("5", "AccessType=ro\nDefaultValue=3"), Rules{"9:14 sub-0-value"});
  EXPECT_EQ(with("5", "AccessType=const\nDefaultValue=1"), Rules{"9:14 sub-0-value"});
  // What is filled later may begin with less.
  EXPECT_EQ(with("5", "AccessType=rw\nDefaultValue=0"), Rules{});
  EXPECT_EQ(with("5", "AccessType=rw\nDefaultValue=3"), Rules{"9:14 sub-0-value"});
  EXPECT_EQ(with("5", "AccessType=ro\nDefaultValue=0", "1A00"), Rules{});
  EXPECT_EQ(with("5", "AccessType=ro\nDefaultValue=0", "1003"), Rules{});
  EXPECT_EQ(with("5", "AccessType=rw\nDefaultValue=254", "1600"), Rules{});
  EXPECT_EQ(with("5", "AccessType=ro\nDefaultValue=6", "1800"), Rules{});
  EXPECT_EQ(with("5", "AccessType=ro\nDefaultValue=7", "1800"), Rules{"9:14 sub-0-value"});
}

TEST(EdsSub0, IsMissedInARecord) {
  const auto file =
      read_sheet("[2000]\nParameterName=X\nObjectType=9\nSubNumber=1\n" + variable("2000sub1", "5", ""));
  EXPECT_TRUE(std::any_of(file.diagnostics.begin(), file.diagnostics.end(),
                          [](const Diagnostic& d) { return d.rule == "missing-sub-0"; }));
}

TEST(EdsSheet, HasADeviceAndTheObjectsOfEveryDevice) {
  const auto missing = [](const std::string& text) {
    std::vector<std::string> out;
    for (const auto& d : read_sheet(text).diagnostics) out.push_back(d.message);
    return out;
  };
  EXPECT_EQ(
      missing(variable("2000", "7", "")),
      (std::vector<std::string>{"there is no [DeviceInfo]", "1000 (device type) is missing: it is mandatory",
                                "1001 (error register) is missing: it is mandatory",
                                "1018 (identity) is missing: it is mandatory"}));
  EXPECT_EQ(missing("[DeviceInfo]\nVendorName=A\n" + variable("1000", "7", "") + variable("1001", "5", "") +
                    "[1018]\nParameterName=I\nObjectType=9\nSubNumber=2\n" +
                    variable("1018sub0", "5", "DefaultValue=1") + variable("1018sub1", "7", "")),
            std::vector<std::string>{});
}

}  // namespace
}  // namespace servoctl::od
