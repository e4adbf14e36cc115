// What a file says of the device: every field, and the numbers at the edge of what is taken.
#include "tests/od/eds_support.hpp"
#include "tests/od/guarded_text.hpp"

namespace servoctl::od {
namespace {

TEST(EdsDevice, HasNamesNumbersAndBitrates) {
  const auto file = read(
      "[DeviceInfo]\nVendorName=Example\nProductName=X1\nVendorNumber=0xFFFFFFFF\nProductNumber=2\n"
      "RevisionNumber=0x30004\nBaudRate_10=1\nBaudRate_20=1\nBaudRate_50=1\nBaudRate_100=1\nBaudRate_125=1\n"
      "BaudRate_250=1\nBaudRate_500=1\nBaudRate_800=1\nBaudRate_1000=1\n" +
      kGood);
  EXPECT_EQ(findings(file), Rules{});
  EXPECT_EQ(file.device.vendor_name, "Example");
  EXPECT_EQ(file.device.product_name, "X1");
  EXPECT_EQ(file.device.vendor_number, 0xFFFF'FFFFU);
  EXPECT_EQ(file.device.product_number, 2U);
  EXPECT_EQ(file.device.revision_number, 0x30004U);
  EXPECT_EQ(file.device.bitrates, (std::vector<std::uint32_t>{10, 20, 50, 100, 125, 250, 500, 800, 1000}));
}

TEST(EdsDevice, HasNothingThatIsNotWellWritten) {
  const auto file = read(
      "[DeviceInfo]\nVendorNumber=0x100000000\nProductNumber=\nRevisionNumber=-1\nBaudRate_10=0\nBaudRate_20="
      "2\n" +
      kGood);
  EXPECT_EQ(findings(file), (Rules{"2:14 bad-number", "4:16 bad-number"}));
  EXPECT_EQ(file.device.vendor_name, "");
  EXPECT_EQ(file.device.vendor_number, 0U);
  EXPECT_EQ(file.device.product_number, 0U);
  EXPECT_EQ(file.device.revision_number, 0U);
  EXPECT_EQ(file.device.bitrates, std::vector<std::uint32_t>{});
}

TEST(EdsDevice, MayMapADummyOfEverySmallType) {
  std::string text = "[DummyUsage]\n";
  for (int code = 0; code < 9; ++code) text += "Dummy000" + std::to_string(code) + "=1\n";
  EXPECT_EQ(read(text + kGood).device.dummies,
            (std::vector<DataType>{DataType::boolean, DataType::i8, DataType::i16, DataType::i32,
                                   DataType::u8, DataType::u16, DataType::u32}));
  const auto file = read("[DummyUsage]\nDummy0005=2\nDummy0006=\nDummy0007=0\n" + kGood);
  EXPECT_EQ(findings(file), Rules{"2:11 bad-number"});
  EXPECT_TRUE(file.device.dummies.empty());
}

TEST(EdsNodeId, IsOneOf127OrUnconfigured) {
  struct Row {
    const char* written;
    int node;
    Rules findings;
  };
  for (const auto& row : {Row{"1", 1, {}}, Row{"127", 127, {}}, Row{"255", 0, {}}, Row{"", 0, {}},
                          Row{"128", 0, {"2:8 bad-number"}}, Row{"254", 0, {"2:8 bad-number"}},
                          Row{"256", 0, {"2:8 bad-number"}}, Row{"five", 0, {"2:8 bad-number"}}}) {
    const auto file = read("[DeviceComissioning]\nNodeID=" + std::string(row.written) + "\n" + kGood);
    EXPECT_EQ(file.node_id, row.node) << row.written;
    EXPECT_EQ(findings(file), row.findings) << row.written;
  }
  EXPECT_EQ(read("[DeviceComissioning]\nNodeName=x\n" + kGood).node_id, 0);
}

TEST(EdsNote, NeedsOneOfItsThreeTextsOnly) {
  const auto file = read(variable("2000", "7", "Denotation=a") + variable("2001", "0xF", "UploadFile=b") +
                         variable("2002", "0xF", "DownloadFile=c") + variable("2003", "7", ""));
  ASSERT_EQ(file.notes.size(), 3U);
  EXPECT_EQ(file.notes[0].denotation, "a");
  EXPECT_EQ(file.notes[1].upload_file, "b");
  EXPECT_EQ(file.notes[2].download_file, "c");
  EXPECT_EQ(file.notes[2].address, (ObjectAddress{0x2002, 0}));
}

TEST(EdsEntry, KnowsItsLineAndItsName) {
  const auto file = read(
      "[2000]\nParameterName=X\nObjectType=9\nSubNumber=2\n[2000sub0]\nParameterName=Count\n"
      "DataType=5\nAccessType=ro\n[2000sub1]\nDataType=0x7\nAccessType=rw\n");
  EXPECT_EQ(findings(file), Rules{"9:1 missing-name"});
  EXPECT_EQ(file.dictionary.object(0x2000)->name, "X");
  EXPECT_EQ(file.dictionary.find({0x2000, 0})->line, 5U);
  EXPECT_EQ(file.dictionary.find({0x2000, 1})->line, 9U);
  EXPECT_EQ(file.dictionary.find({0x2000, 1})->name, "");
  EXPECT_EQ(findings(read(variable("2000", "7", "ParameterName="))),
            (Rules{"1:1 missing-name", "5:15 duplicate-key"}));
}

TEST(EdsLimits, ThatTheDefaultIsOutOfAreNamedAsTheyAreWritten) {
  const auto said = [](const char* keys) {
    return read(variable("2000", "5", keys)).diagnostics.front().message;
  };
  EXPECT_EQ(said("HighLimit=0x04\nDefaultValue=0x05"),
            "[2000]: DefaultValue 0x05 (5) is above HighLimit 0x04 (4)");
  EXPECT_EQ(said("LowLimit=4\nDefaultValue=3"), "[2000]: DefaultValue 3 is below LowLimit 4");
}

TEST(EdsLimits, MayMeetEachOtherAndTheDefault) {
  EXPECT_EQ(findings(read(variable("2000", "2", "LowLimit=-1\nHighLimit=-1\nDefaultValue=-1"))), Rules{});
  EXPECT_EQ(findings(read(variable("2000", "7", "LowLimit=$NODEID\nHighLimit=1"))), Rules{});
  EXPECT_EQ(findings(read(variable("2000", "7", "LowLimit=2\nHighLimit=$NODEID"))),
            Rules{"1:1 limits-crossed"});
  EXPECT_EQ(findings(read(variable("2000", "7", "LowLimit=$NODEID+1\nHighLimit=1"))),
            Rules{"1:1 limits-crossed"});
  EXPECT_EQ(findings(read(variable("2000", "7", "HighLimit=4\nDefaultValue=5"))),
            Rules{"1:1 default-out-of-limits"});
  EXPECT_EQ(findings(read(variable("2000", "7", "LowLimit=4\nDefaultValue=3"))),
            Rules{"1:1 default-out-of-limits"});
}

TEST(EdsList, NamesObjectsThatHaveASectionEvenIfItIsOfNoUse) {
  const auto file = read(
      "[ManufacturerObjects]\nSupportedObjects=2\n1=0x2000\n2=0x2FFF\n[2000]\nParameterName=X\n" + kGood);
  EXPECT_EQ(findings(file), Rules{"5:1 missing-data-type"});
}

TEST(EdsList, IsComparedWithTheSectionsThereAre) {
  const auto with = [](const std::string& lines) {
    return findings(read("[ManufacturerObjects]\n" + lines + kGood));
  };
  EXPECT_EQ(with("SupportedObjects=1\n1=0x2FFF\n"), Rules{});
  EXPECT_EQ(with("1=0x2FFF\nSupportedObjects=0x1\n"), Rules{});
  EXPECT_EQ(with("SupportedObjects=\n1=0x2FFF\n2=\n"), Rules{});
  EXPECT_EQ(with("SupportedObjects=0\n1=0x2FFF\n"), Rules{"2:18 wrong-object-count"});
  EXPECT_EQ(with("SupportedObjects=65536\n1=0x2FFF\n"), Rules{"2:18 bad-number"});
  EXPECT_EQ(with("SupportedObjects=2\n1=0x2FFF\n2=0xFFFF\n"),
            (Rules{"4:3 listed-but-absent", "4:3 wrong-list"}));
  EXPECT_EQ(with("SupportedObjects=2\n1=0x2FFF\n2=0x10000\n"), Rules{"4:3 bad-number"});
  EXPECT_EQ(with("SupportedObjects=2\n1=0x2FFF\n2=12287\n"), Rules{"4:3 listed-twice"});
  EXPECT_EQ(with("SupportedObjects=1\n1=12287\n"), Rules{});
  EXPECT_EQ(with("SupportedObjects=0\n"), Rules{"3:1 not-listed"});
  EXPECT_EQ(with("SupportedObjects=2\n1=0x2FFF\n2=12FFF\n"), Rules{"4:3 bad-number"});
  EXPECT_EQ(with("SupportedObjects=2\n1=0x2FFF\n2=12345\n"), Rules{"4:3 listed-but-absent"});
  EXPECT_EQ(with("SupportedObjects=2\n1=0x2FFF\n2=1234\n"), Rules{"4:3 listed-but-absent"});
  EXPECT_EQ(with("SupportedObjects=3\n1=0x2FFF\n2=10000\n3=0\n" + variable("0000", "7", "")),
            Rules{"4:3 listed-but-absent"});
}

TEST(EdsList, WithAWrongCountSaysTheRightOne) {
  const auto file = read("[ManufacturerObjects]\nSupportedObjects=7\n1=0x2FFF\n2=\n" + kGood);
  EXPECT_EQ(file.diagnostics.front().message, "SupportedObjects is 7, but 2 follow");
  EXPECT_EQ(file.diagnostics.front().remedy, "write SupportedObjects=2");
}

TEST(EdsList, MayStandInSeveralSections) {
  const auto file = read(
      "[OptionalObjects]\nSupportedObjects=1\n1=0x6000\n[ManufacturerObjects]\n"
      "SupportedObjects=1\n1=0x2000\n" +
      variable("6000", "7", "") + variable("2000", "7", ""));
  EXPECT_EQ(findings(file), Rules{});
  EXPECT_EQ(file.dictionary.entry_count(), 2U);
}

TEST(EdsText, IsNotReadBeyondItsEnd) {
  for (const auto* end : {"DefaultValue=0", "DefaultValue=$", "DefaultValue=", "=", "[2000", "[", "\r",
                          "\xE9", "DefaultValue=$NODEID", "[2000sub", "[Tool", "[M", "[2000s", "LowLimit=0x",
                          "ParameterName=\xCB\xD9\xB6\xC8"}) {
    const GuardedText text(variable("2000", "7", "") + end);
    EXPECT_NE(read(text.text()).dictionary.find({0x2000, 0}), nullptr) << end;
  }
}

TEST(EdsText, MayHaveASingleNul) {
  auto text = kGood;
  text.insert(20, 1, '\0');
  const auto file = read(text);
  EXPECT_EQ(findings(file), Rules{"2:14 nul-byte"});
  EXPECT_EQ(file.diagnostics.front().message, "1 NUL bytes are skipped");
}

TEST(EdsText, WithTheWrongEncodingTellsHowManyPlacesAreLost) {
  EXPECT_EQ(read(variable("2000", "7", "Denotation=\xE9 \x9D \x9D")).diagnostics.front().message,
            "the file is taken as CP1252; 2 bytes mean nothing in it and are written out, as \\xFF");
  EXPECT_EQ(read("\xEF\xBB\xBF" + variable("2000", "7", "Denotation=\xFF")).diagnostics.front().message,
            "the file is taken as UTF-8; 1 bytes mean nothing in it and are written out, as \\xFF");
}

}  // namespace
}  // namespace servoctl::od
