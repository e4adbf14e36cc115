#include "od/eds.hpp"

#include "eds_support.hpp"

#include <gtest/gtest.h>

namespace servoctl::od {
namespace {

/// `[1000]` as it should be, so that a file has one usable object; 7 lines.
constexpr std::string_view kGoodDevice =
    "[1000]\nParameterName=Device "
    "type\nObjectType=0x7\nDataType=0x0007\nAccessType=ro\nDefaultValue=0x192\nPDOMapping=0\n";

/// The one finding of kGoodDevice followed by `text`.
void expect_finding(std::string_view text, Severity severity, std::string_view rule, std::uint32_t line,
                    std::uint32_t column) {
  const auto file = read(std::string(kGoodDevice) + std::string(text));
  ASSERT_EQ(file.diagnostics.size(), 1U)
      << text << (file.diagnostics.empty() ? "" : "\n" + to_string(file.diagnostics.back(), "x"));
  const auto& d = file.diagnostics.front();
  EXPECT_EQ(d.rule, rule);
  EXPECT_EQ(d.severity, severity) << rule;
  EXPECT_EQ(d.line, line) << rule;
  EXPECT_EQ(d.column, column) << rule;
  EXPECT_FALSE(d.message.empty());
  EXPECT_FALSE(d.remedy.empty());
  EXPECT_NE(file.dictionary.find({0x1000, 0}), nullptr) << "the good object is lost";
}

constexpr auto kWarning = Severity::warning;
constexpr auto kError = Severity::error;

TEST(Eds, GivesTypesLimitsDefaultsAndNames) {
  const auto file = read(
      "[DeviceInfo]\nVendorName=Example\nProductName=X1\nVendorNumber=0x12\nBaudRate_125=1\nBaudRate_500="
      "1\nBaudRate_1000=0\n"
      "[6099]\nParameterName=Homing speeds\nObjectType=0x8\nSubNumber=2\n"
      "[6099sub0]\nParameterName=Count\nDataType=5\nAccessType=const\nDefaultValue=1\n"
      "[6099sub1]\nParameterName=Switch\nObjectType=0x7\nDataType=0x0004\nAccessType=rw\nLowLimit="
      "0x80000000\nHighLimit=0x7FFFFFFF\nDefaultValue=-5\nPDOMapping=1\n");
  EXPECT_TRUE(file.diagnostics.empty()) << to_string(file.diagnostics.front(), "x");
  EXPECT_EQ(file.device.vendor_name, "Example");
  EXPECT_EQ(file.device.vendor_number, 0x12U);
  EXPECT_EQ(file.device.bitrates, (std::vector<std::uint32_t>{125, 500}));
  const auto* entry = file.dictionary.find({0x6099, 1});
  ASSERT_NE(entry, nullptr);
  EXPECT_EQ(entry->name, "Switch");
  EXPECT_EQ(entry->type, DataType::i32);
  EXPECT_EQ(entry->access, Access::rw);
  EXPECT_EQ(entry->pdo, PdoMapping::both);
  EXPECT_EQ(to_string(entry->default_value->value), "-5");
  EXPECT_EQ(to_string(entry->low->value), "-2147483648");
  EXPECT_EQ(to_string(entry->high->value), "2147483647");
  EXPECT_EQ(file.dictionary.find({0x6099, 0})->access, Access::constant);
  EXPECT_EQ(file.dictionary.object(0x6099)->code, ObjectCode::array);
  EXPECT_EQ(file.dictionary.entry_count(), 2U);
}

TEST(Eds, UnderstandsTheNodeIdInAnyCaseAndOnEitherSide) {
  for (const auto* text : {"$NODEID+0x600", "$NodeId + 0x600", "0x600+$NODEID", "0x600 + $nodeid"}) {
    const auto file =
        read("[1200]\nParameterName=X\nDataType=7\nAccessType=rw\nDefaultValue=" + std::string(text) + "\n");
    ASSERT_TRUE(file.dictionary.find({0x1200, 0})->default_value) << text;
    const auto& value = *file.dictionary.find({0x1200, 0})->default_value;
    EXPECT_TRUE(value.plus_node_id) << text;
    EXPECT_EQ(to_string(value.for_node(5)), "1541") << text;
  }
  const auto alone = read("[1200]\nParameterName=X\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID\n");
  EXPECT_EQ(to_string(alone.dictionary.find({0x1200, 0})->default_value->for_node(5)), "5");
}

TEST(Eds, ReadsAccessInAnyCaseWithTheDirectionItTells) {
  const std::pair<const char*, std::pair<Access, PdoMapping>> rows[] = {
      {"RO", {Access::ro, PdoMapping::tpdo}},
      {"wo", {Access::wo, PdoMapping::rpdo}},
      {"Const", {Access::constant, PdoMapping::tpdo}},
      {"rwr", {Access::rw, PdoMapping::tpdo}},
      {"RWW", {Access::rw, PdoMapping::rpdo}}};
  for (const auto& row : rows) {
    const auto file = read(
        "[2000]\nParameterName=X\nDataType=7\nPDOMapping=1\nAccessType=" + std::string(row.first) + "\n");
    EXPECT_EQ(file.dictionary.find({0x2000, 0})->access, row.second.first) << row.first;
    EXPECT_EQ(file.dictionary.find({0x2000, 0})->pdo, row.second.second) << row.first;
  }
}

TEST(Eds, TakesSubIndexesForHexadecimal) {
  const auto file = read(
      "[2000]\nParameterName=X\nObjectType=9\nSubNumber=1\n[2000sub1F]\nParameterName=Y\nDataType="
      "5\nAccessType=rw\n");
  EXPECT_NE(file.dictionary.find({0x2000, 0x1F}), nullptr);
}

TEST(Eds, ExpandsCompactSubObjects) {
  const auto file = read(
      "[2010]\nParameterName=Gain\nObjectType=8\nDataType=6\nAccessType=rw\nDefaultValue=7\nCompactSubObj=3\n"
      "[2010Name]\nNrOfEntries=1\n2=Second\n[2010Value]\nNrOfEntries=1\n3=9\n");
  EXPECT_TRUE(file.diagnostics.empty()) << to_string(file.diagnostics.front(), "x");
  EXPECT_EQ(to_string(file.dictionary.find({0x2010, 0})->default_value->value), "3");
  EXPECT_EQ(file.dictionary.find({0x2010, 1})->name, "Gain1");
  EXPECT_EQ(file.dictionary.find({0x2010, 2})->name, "Second");
  EXPECT_EQ(to_string(file.dictionary.find({0x2010, 1})->default_value->value), "7");
  EXPECT_EQ(to_string(file.dictionary.find({0x2010, 3})->configured->value), "9");
  EXPECT_EQ(file.dictionary.find({0x2010, 4}), nullptr);
}

TEST(Eds, OfADcfGivesNodeIdAndConfiguredValues) {
  const auto file = read(
      "[DeviceComissioning]\nNodeID=5\n[1017]\nParameterName=H\nDataType=6\nAccessType=rw\nDefaultValue="
      "0\nParameterValue=250\n");
  EXPECT_EQ(file.node_id, 5);
  EXPECT_EQ(to_string(file.dictionary.find({0x1017, 0})->configured->value), "250");
  EXPECT_EQ(read("[DeviceCommissioning]\nNodeID=6\n" + std::string(kGoodDevice)).node_id, 6);
}

TEST(Eds, TakesAllLineEndsCommentsAndAByteOrderMark) {
  for (const auto* end : {"\n", "\r\n", "\r"}) {
    std::string text = "\xEF\xBB\xBF; a comment\n" + std::string(kGoodDevice);
    std::string turned;
    for (const char c : text) turned += c == '\n' ? std::string(end) : std::string(1, c);
    const auto file = read(turned);
    EXPECT_TRUE(file.diagnostics.empty());
    EXPECT_EQ(file.dictionary.find({0x1000, 0})->line, 2U);
  }
}

TEST(EdsFinding, OfEachRuleHasItsPlace) {
  expect_finding("nonsense\n", kError, "stray-line", 8, 1);
  expect_finding("[Nonsense]\nDataType=5\n", kWarning, "unknown-section", 8, 1);
  expect_finding("[1000]\nDataType=7\n", kError, "duplicate-section", 8, 1);
  expect_finding("[1001]\nParameterName=E\nAccessType=ro\n", kError, "missing-data-type", 8, 1);
  expect_finding("[1001]\nParameterName=E\nDataType=0x1F\nAccessType=ro\n", kError, "unknown-data-type", 10,
                 10);
  expect_finding("[1001]\nParameterName=E\nDataType=five\nAccessType=ro\n", kError, "bad-number", 10, 10);
  expect_finding("[1001]\nParameterName=E\nDataType=5\n", kError, "missing-access-type", 8, 1);
  expect_finding("[1001]\nParameterName=E\nDataType=5\nAccessType = maybe\n", kError, "unknown-access-type",
                 11, 14);
  expect_finding("[1001]\nDataType=5\nAccessType=ro\n", kWarning, "missing-name", 8, 1);
  expect_finding("[1001]\nParameterName=E\nDataType=5\nAccessType=ro\nDefaultValue=300\n", kError,
                 "bad-value", 12, 14);
  expect_finding("[1001]\nParameterName=E\nDataType=5\nAccessType=ro\nDefaultValue=007\n", kWarning,
                 "leading-zero", 12, 14);
  expect_finding("[1001]\nParameterName=E\nDataType=5\nDataType=5\nAccessType=ro\n", kWarning,
                 "duplicate-key", 11, 10);
  expect_finding("[1001]\nParameterName=E\nDataType=5\nAccessType=ro\nLowLimit=9\nHighLimit=3\n", kWarning,
                 "limits-crossed", 8, 1);
  expect_finding("[1001]\nParameterName=E\nDataType=5\nAccessType=ro\nLowLimit=1\nDefaultValue=0\n", kWarning,
                 "default-out-of-limits", 8, 1);
  expect_finding("[1001]\nParameterName=E\nObjectType=0x77\nDataType=5\nAccessType=ro\n", kError,
                 "unknown-object-type", 10, 12);
  expect_finding("[1018sub1]\nParameterName=E\nDataType=5\nAccessType=ro\n", kError, "missing-object", 8, 1);
  expect_finding(
      "[1018]\nParameterName=E\nObjectType=9\nSubNumber=3\n[1018sub0]\nParameterName=E\nDataType="
      "5\nAccessType=ro\n",
      kWarning, "wrong-sub-number", 11, 11);
  expect_finding(
      "[1018]\nParameterName=E\nObjectType=9\n[1018sub0]\nParameterName=E\nDataType=5\nAccessType=ro\n",
      kWarning, "missing-sub-number", 8, 1);
  expect_finding("[MandatoryObjects]\n1=0x1000\n2=0x1001\n", kError, "listed-but-absent", 10, 3);
  expect_finding("[MandatoryObjects]\nSupportedObjects=0\n", kWarning, "not-listed", 1, 1);
  expect_finding("[1001]\nParameterName=E\nDataType=5\nAccessType=ro\nLowLimit=-1\n", kWarning,
                 "limit-outside-type", 12, 10);
  expect_finding("[1001]\nParameterName=E\nDataType=5\nAccessType=ro\nDefaultVaule=1\n", kWarning,
                 "misspelt-key", 12, 14);
  expect_finding("[OptionalObjects]\n1=0x1000\n", kWarning, "wrong-list", 9, 3);
  expect_finding("[MandatoryObjects]\n1=0x1000\n2=0x1000\n", kWarning, "listed-twice", 10, 3);
}

TEST(EdsFinding, TakesNothingOfAnEntryThatIsGood) {
  const auto file = read(std::string(kGoodDevice) +
                         "[1001]\nParameterName=E\nDataType=5\nAccessType=ro\nDefaultValue=\nLowLimit=\n");
  EXPECT_TRUE(file.diagnostics.empty());
  EXPECT_FALSE(file.dictionary.find({0x1001, 0})->default_value);
}

TEST(Eds, WithoutAnyObjectIsRefused) {
  for (const auto* text : {"", "hello", "[1000]\n", "\0\0\0"}) {
    const auto file = read_eds(text, "x.eds");
    ASSERT_FALSE(file) << text;
    EXPECT_EQ(file.error().code, Errc::file);
    EXPECT_EQ(file.error().message.text(), "x.eds: there is no usable object in this file");
  }
}

TEST(Eds, InXmlIsNamedAsThat) {
  for (const auto* text :
       {"\xEF\xBB\xBF<?xml version=\"1.0\"?>\n<ISO15745ProfileContainer/>\n", "\n <Device/>"}) {
    const auto file = read_eds(text, "x.xdd");
    ASSERT_FALSE(file) << text;
    EXPECT_EQ(file.error().message.text(), "x.xdd: this is XML, not an EDS or DCF file");
    EXPECT_NE(file.error().hint.text().find("CiA 311"), std::string::npos);
  }
}

TEST(Diagnostic, IsShownAsCompilersDo) {
  EXPECT_EQ(to_string({Severity::error, 12, 9, "bad-value", "no good", "mend it"}, "x.eds"),
            "x.eds:12:9: error: no good [bad-value]");
}

}  // namespace
}  // namespace servoctl::od
