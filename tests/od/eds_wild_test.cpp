// Files as they are in the wild: what the book does not allow and tools write all the same.
#include "tests/od/eds_support.hpp"

namespace servoctl::od {
namespace {

TEST(EdsValue, MayHaveTheNodeIdInLimitsAndConfiguredValues) {
  const auto file = read(variable(
      "1400", "7",
      "LowLimit=$NODEID\nHighLimit=$nodeid+0x200\nDefaultValue=0x100+$NodeID\nParameterValue=$NODEID+1"));
  EXPECT_EQ(findings(file), Rules{});
  const auto* entry = file.dictionary.find({0x1400, 0});
  EXPECT_EQ(to_string(entry->low->for_node(5)), "5");
  EXPECT_EQ(to_string(entry->high->for_node(5)), "517");
  EXPECT_EQ(to_string(entry->default_value->for_node(5)), "261");
  EXPECT_EQ(to_string(entry->configured->for_node(5)), "6");
}

TEST(EdsValue, OfATypeWithOddWidthHasSignedLimitsInHexadecimal) {
  const std::pair<const char*, const char*> rows[] = {{"0x10", "-8388608"},
                                                      {"0x12", "-549755813888"},
                                                      {"0x13", "-140737488355328"},
                                                      {"0x14", "-36028797018963968"}};
  std::size_t bytes = 3;
  for (const auto& row : rows) {
    if (bytes == 4) ++bytes;
    const auto digits = std::string(2 * bytes - 1, '0');
    const auto file = read(variable("2000", row.first, "LowLimit=0x8" + digits));
    EXPECT_EQ(to_string(file.dictionary.find({0x2000, 0})->low->value), row.second);
    EXPECT_EQ(findings(file), Rules{});
    ++bytes;
  }
}

TEST(EdsValue, InComplementOfAWiderTypeIsTakenWithAWarning) {
  const auto file = read(variable("2000", "2", "LowLimit=0xFFFFFF80\nHighLimit=127"));
  EXPECT_EQ(to_string(file.dictionary.find({0x2000, 0})->low->value), "-128");
  EXPECT_EQ(findings(file), Rules{"5:10 wide-value"});
}

TEST(EdsValue, WithLeadingZerosIsDecimalWithAWarning) {
  const auto file = read(variable("2000", "7", "DefaultValue=0010"));
  EXPECT_EQ(default_of(file, {0x2000, 0}), "10");
  EXPECT_EQ(findings(file), Rules{"5:14 leading-zero"});
}

TEST(EdsValue, OfADomainIsNotLookedAt) {
  EXPECT_EQ(findings(read(variable("2000", "0xF", "DefaultValue=none"))), Rules{});
}

TEST(EdsValue, OfARealMayBeItsBits) {
  EXPECT_EQ(default_of(read(variable("2000", "8", "DefaultValue=0x3FC00000")), {0x2000, 0}), "1.5");
  EXPECT_EQ(default_of(read(variable("2000", "0x11", "DefaultValue=0x4000000000000000")), {0x2000, 0}), "2");
  EXPECT_EQ(findings(read(variable("2000", "8", "DefaultValue=0x3FC0"))), Rules{"5:14 bad-value"});
}

TEST(EdsValue, OfATimeIsDaysAndMillisecondsOrOneNumber) {
  EXPECT_EQ(default_of(read(variable("2000", "0xC", "DefaultValue=1 2")), {0x2000, 0}), "02 00 00 00 01 00");
  EXPECT_EQ(default_of(read(variable("2000", "0xD", "DefaultValue=0x30")), {0x2000, 0}), "30 00 00 00 00 00");
  EXPECT_EQ(findings(read(variable("2000", "0xC", "DefaultValue=70000 1"))), Rules{"5:14 bad-value"});
}

TEST(EdsValue, WithTheNodeIdInItsMiddleIsTold) {
  EXPECT_EQ(findings(read(variable("2000", "7", "DefaultValue=1+$NODEID+2"))), Rules{"5:14 bad-value"});
}

TEST(EdsValue, InHexadecimalMayHaveLeadingZeros) {
  for (const auto* text : {"0x0010", "0010h", "0"})
    EXPECT_EQ(findings(read(variable("2000", "7", "DefaultValue=" + std::string(text)))), Rules{}) << text;
}

TEST(EdsLimits, ThatCrossAreNotUsed) {
  const auto file = read(variable("2000", "2", "LowLimit=0\nHighLimit=0xFF\nDefaultValue=1"));
  EXPECT_EQ(findings(file), Rules{"1:1 limits-crossed"});
  EXPECT_EQ(file.diagnostics.front().message,
            "[2000]: LowLimit 0 is above HighLimit 0xFF (-1) in i8; neither is used");
  EXPECT_FALSE(file.dictionary.find({0x2000, 0})->low);
  EXPECT_FALSE(file.dictionary.find({0x2000, 0})->high);
}

TEST(EdsComment, BehindANumberIsSkippedWithAWarning) {
  const auto file = read("[2000]\nParameterName=X\nDataType=0x7 # a comment\nAccessType=ro ; another\n");
  EXPECT_EQ(findings(file), (Rules{"3:10 trailing-comment", "4:12 trailing-comment"}));
  EXPECT_EQ(file.dictionary.find({0x2000, 0})->access, Access::ro);
}

TEST(EdsComment, OfAnotherFormatIsSkippedWithAWarning) {
  const auto file = read(variable("2000", "7", "# a=b\n// c"));
  EXPECT_EQ(findings(file), (Rules{"5:1 foreign-comment", "6:1 foreign-comment"}));
}

TEST(EdsType, GivenByNameIsTakenWithAWarning) {
  const auto file = read("[2000]\nParameterName=X\nObjectType=VAR\nDataType=INTEGER32\nAccessType=RW\n");
  EXPECT_EQ(findings(file), (Rules{"3:12 name-for-number", "4:10 name-for-number"}));
  EXPECT_EQ(file.dictionary.find({0x2000, 0})->type, DataType::i32);
}

TEST(EdsType, OfADomainObjectNeedsNoDataType) {
  const auto file = read("[2000]\nParameterName=X\nObjectType=2\nAccessType=rw\n");
  EXPECT_EQ(findings(file), Rules{});
  EXPECT_EQ(file.dictionary.find({0x2000, 0})->type, DataType::domain);
}

TEST(EdsAccess, WrittenOtherwiseIsTakenWithAWarning) {
  const std::pair<const char*, Access> rows[] = {{"R", Access::ro}, {"W", Access::wo}, {"R/W", Access::rw}};
  for (const auto& row : rows) {
    const auto file =
        read("[2000]\nParameterName=X\nDataType=7\nAccessType=" + std::string(row.first) + "\n");
    EXPECT_EQ(file.dictionary.find({0x2000, 0})->access, row.second);
    EXPECT_EQ(findings(file), Rules{"4:12 access-spelling"});
  }
}

TEST(EdsAccess, ThatIsMisspeltComesWithAProposal) {
  const auto file = read("[2000]\nParameterName=X\nDataType=7\nAccessType=cosnt\n");
  EXPECT_EQ(findings(file), Rules{"4:12 unknown-access-type"});
  EXPECT_EQ(file.diagnostics.front().remedy, "did you mean const?");
  EXPECT_EQ(file.dictionary.find({0x2000, 0})->access, Access::ro);
}

TEST(EdsSection, ThatIsMisspeltIsTakenForWhatItMeans) {
  for (const auto* name : {"0x2000", "2000 ", "20_00"})
    EXPECT_NE(read(variable(name, "7", "")).dictionary.find({0x2000, 0}), nullptr) << name;
  for (const auto* name : {"2000 sub1", "2000_Sub1", "2000sbu1", "0x2000sub1"}) {
    const auto file = read("[2000]\nParameterName=X\nObjectType=9\nSubNumber=1\n" + variable(name, "7", ""));
    ASSERT_NE(file.dictionary.find({0x2000, 1}), nullptr) << name;
    EXPECT_EQ(findings(file), Rules{"5:1 misspelt-section"}) << name;
    EXPECT_EQ(file.diagnostics.front().remedy.substr(0, 11), "write [2000") << name;
  }
  const auto file = read(variable("2000", "7", "[ManufactuerObjects]\nSupportedObjects=1\n1=0x2000"));
  EXPECT_EQ(findings(file), Rules{"5:1 misspelt-section"});
}

TEST(EdsSection, WithoutItsBracketIsTakenWithAWarning) {
  const auto file = read("[2000\nParameterName=X\nDataType=7\nAccessType=ro\n");
  EXPECT_EQ(findings(file), Rules{"1:1 unclosed-section"});
}

TEST(EdsSection, OfLinksAndModulesIsKnown) {
  std::string text = variable("2000", "7", "");
  for (const auto* name :
       {"2000ObjectLinks", "SupportedModules", "ConnectedModules", "M1ModuleInfo", "M12Comments",
        "M1FixedObjects", "M1Fixed2000", "M1Fixed2000sub1", "M2SubExtends", "M2SubExt6000",
        "M2SubExt6000sub0", "DynamicChannels", "Tools", "Tool1", "StandardDataTypes"})
    text += "[" + std::string(name) + "]\nParameterName=X\n";
  EXPECT_EQ(findings(read(text)), Rules{});
}

TEST(EdsSubIndex, InDecimalIsSeenByTheMissingGap) {
  std::string text = "[2000]\nParameterName=X\nObjectType=9\nSubNumber=12\n";
  for (int sub = 0; sub < 12; ++sub) text += variable("2000sub" + std::to_string(sub), "5", "");
  const auto file = read(text);
  EXPECT_EQ(findings(file), Rules{"5:1 decimal-sub-index"});
  EXPECT_NE(file.dictionary.find({0x2000, 11}), nullptr);
  EXPECT_EQ(file.dictionary.find({0x2000, 0x11}), nullptr);
}

TEST(EdsSubIndex, InDecimalIsSeenByNumbersAboveTheHighest) {
  const auto file = read("[2000]\nParameterName=X\nObjectType=9\nSubNumber=2\n" +
                         variable("2000sub1", "5", "") + variable("2000sub253", "5", ""));
  EXPECT_EQ(findings(file), Rules{"5:1 decimal-sub-index"});
  EXPECT_NE(file.dictionary.find({0x2000, 253}), nullptr);
}

TEST(EdsSubIndex, StaysHexadecimalWhereDecimalWouldLeaveAGap) {
  const auto file = read("[2000]\nParameterName=X\nObjectType=9\nSubNumber=2\n" +
                         variable("2000sub1", "5", "") + variable("2000sub10", "5", ""));
  EXPECT_EQ(findings(file), Rules{});
  EXPECT_NE(file.dictionary.find({0x2000, 0x10}), nullptr);
}

TEST(EdsCompact, KeepsEntriesThatHaveASectionAndTakesDenotations) {
  const auto file =
      read(variable("2000", "5", "ObjectType=8\nCompactSubObj=3") +
           variable("2000sub2", "5", "DefaultValue=9") + "[2000Denotation]\n3=Third\n[2000Value]\n4=1\n");
  EXPECT_EQ(findings(file), Rules{"15:3 no-such-entry"});
  ASSERT_EQ(file.dictionary.object(0x2000)->entries.size(), 4U);
  EXPECT_EQ(file.dictionary.object(0x2000)->entries[2].address.sub, 2);
  EXPECT_EQ(default_of(file, {0x2000, 2}), "9");
  ASSERT_EQ(file.notes.size(), 1U);
  EXPECT_EQ(file.notes[0].address, (ObjectAddress{0x2000, 3}));
  EXPECT_EQ(file.notes[0].denotation, "Third");
}

TEST(EdsCompactPdo, MakesTheObjectsThatAreCountedAndNotListed) {
  const auto file = read(
      "[DeviceInfo]\nCompactPDO=0x13\nGranularity=16\nNrOfRXPDO=2\nNrOfTXPDO=1\n[OptionalObjects]\n"
      "SupportedObjects=2\n1=0x1400\n2=0x1401\n" +
      variable("1400", "7", ""));
  EXPECT_EQ(findings(file), Rules{});
  EXPECT_EQ(default_of(file, {0x1401, 0}), "5");
  EXPECT_EQ(default_of(file, {0x1401, 1}), "773");
  EXPECT_EQ(file.dictionary.find({0x1401, 3}), nullptr);
  EXPECT_EQ(file.dictionary.find({0x1401, 5})->type, DataType::u16);
  EXPECT_EQ(file.dictionary.object(0x1601)->entries.size(), 5U);
  EXPECT_EQ(default_of(file, {0x1800, 1}), "389");
  EXPECT_EQ(file.dictionary.object(0x1402), nullptr);
  EXPECT_EQ(file.dictionary.object(0x1801), nullptr);
}

TEST(EdsDevice, TellsWhichDummiesMayBeMapped) {
  const auto file =
      read("[DummyUsage]\nDummy0001=0\nDummy0005=1\nDummy0007=0x1\n" + variable("2000", "7", ""));
  EXPECT_EQ(file.device.dummies, (std::vector<DataType>{DataType::u8, DataType::u32}));
}

TEST(EdsNote, KeepsDenotationAndFilesOfADcf) {
  const auto file =
      read(variable("1F50", "0xF", "Denotation=Firmware\nUploadFile=up.bin\nDownloadFile=down.bin") +
           variable("2000", "7", "Denotation="));
  ASSERT_EQ(file.notes.size(), 1U);
  EXPECT_EQ(file.notes[0].address, (ObjectAddress{0x1F50, 0}));
  EXPECT_EQ(file.notes[0].denotation, "Firmware");
  EXPECT_EQ(file.notes[0].upload_file, "up.bin");
  EXPECT_EQ(file.notes[0].download_file, "down.bin");
}

TEST(EdsList, WithAWrongCountOrDecimalNumbersIsTold) {
  const auto file = read("[ManufacturerObjects]\nSupportedObjects=2\n1=2000\n" + variable("2000", "7", ""));
  EXPECT_EQ(findings(file), (Rules{"2:18 wrong-object-count", "3:3 decimal-index"}));
  EXPECT_EQ(file.diagnostics[1].remedy, "write 0x2000: without 0x a number is decimal");
}

TEST(EdsDuplicate, IsToldAndTheFirstSectionAndTheLastKeyCount) {
  const auto file = read(variable("2000", "7", "DefaultValue=1\ndefaultvalue=2") + variable("2000", "5", ""));
  EXPECT_EQ(findings(file), (Rules{"6:14 duplicate-key", "7:1 duplicate-section"}));
  EXPECT_EQ(default_of(file, {0x2000, 0}), "2");
  EXPECT_EQ(file.dictionary.find({0x2000, 0})->type, DataType::u32);
}

TEST(EdsText, WithMergeMarkersNamesEachOfThem) {
  const auto file =
      read(variable("2000", "7", "<<<<<<< HEAD\nDefaultValue=1\n=======\nDefaultValue=2\n>>>>>>> b"));
  EXPECT_EQ(findings(file),
            (Rules{"5:1 merge-marker", "7:1 merge-marker", "8:14 duplicate-key", "9:1 merge-marker"}));
}

TEST(EdsText, MayMixLineEndsAndEndWithTheMarkOfDos) {
  const auto file = read("[2000]\r\nParameterName=X\nDataType=7\rAccessType=ro\r\nDefaultValue=5\x1A");
  EXPECT_EQ(file.diagnostics.size(), 1U);
  EXPECT_EQ(findings(read("[2000]\r\nParameterName=X\nDataType=7\rAccessType=ro\r\n\x1A")), Rules{});
}

TEST(EdsText, MayHaveLinesOfAnyLength) {
  const auto file = read(variable("2000", "9", "DefaultValue=" + std::string(100'000, 'x')));
  EXPECT_EQ(default_of(file, {0x2000, 0}).size(), 100'000U);
  EXPECT_EQ(findings(file), Rules{});
}

}  // namespace
}  // namespace servoctl::od
