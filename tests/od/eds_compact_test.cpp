#include <fmt/format.h>

#include "tests/od/eds_support.hpp"

namespace servoctl::od {
namespace {

std::string compact(std::string_view count, std::string_view more = "") {
  return variable("2000", "6", "ObjectType=8\nDefaultValue=9\nCompactSubObj=" + std::string(count)) +
         std::string(more);
}

TEST(EdsCompact, MakesTheCountAndEveryEntry) {
  const auto file = read(compact("254"));
  EXPECT_EQ(findings(file), Rules{});
  ASSERT_NE(file.dictionary.object(0x2000), nullptr);
  const auto& entries = file.dictionary.object(0x2000)->entries;
  ASSERT_EQ(entries.size(), 255U);
  EXPECT_EQ(entries[0].name, "Highest sub-index supported");
  EXPECT_EQ(entries[0].type, DataType::u8);
  EXPECT_EQ(entries[0].access, Access::ro);
  EXPECT_EQ(entries[0].line, 1U);
  EXPECT_EQ(default_of(file, {0x2000, 0}), "254");
  for (std::size_t sub = 1; sub < entries.size(); ++sub) {
    EXPECT_EQ(entries[sub].address, (ObjectAddress{0x2000, static_cast<std::uint8_t>(sub)}));
    EXPECT_EQ(entries[sub].name, "X" + std::to_string(sub));
    EXPECT_EQ(entries[sub].access, Access::rw);
    EXPECT_EQ(entries[sub].type, DataType::u16);
  }
}

TEST(EdsCompact, IsNoneWithoutANumberAboveZero) {
  EXPECT_EQ(findings(read(compact("0") + kGood)), Rules{"1:1 no-sub-indexes"});
  EXPECT_EQ(findings(read(compact("") + kGood)), Rules{"1:1 no-sub-indexes"});
  EXPECT_EQ(default_of(read(compact("1")), {0x2000, 1}), "9");
}

TEST(EdsCompact, TakesNamesAndValuesByDecimalNumbers) {
  const auto file =
      read(compact("10",
                   "[2000Name]\nNrOfEntries=2\n10=Ten\n1=One\n2=\n11=Eleven\n0x3=Three\n"
                   "[2000Value]\nNrOfEntries=1\n10=0x10\n3=x\n[2000Denotation]\n10=tenth\n1=\n"));
  EXPECT_EQ(findings(file), (Rules{"13:4 no-such-entry", "14:5 no-such-entry", "18:3 bad-value"}));
  EXPECT_EQ(file.dictionary.find({0x2000, 10})->name, "Ten");
  EXPECT_EQ(file.dictionary.find({0x2000, 1})->name, "One");
  EXPECT_EQ(file.dictionary.find({0x2000, 2})->name, "X2");
  EXPECT_EQ(to_string(file.dictionary.find({0x2000, 10})->configured->value), "16");
  EXPECT_FALSE(file.dictionary.find({0x2000, 9})->configured);
  ASSERT_EQ(file.notes.size(), 1U);
  EXPECT_EQ(file.notes[0].address, (ObjectAddress{0x2000, 10}));
}

TEST(EdsCompact, KeepsACountWithASectionOfItsOwn) {
  const auto file =
      read(compact("3", variable("2000sub0", "5", "DefaultValue=7") + variable("2000sub2", "7", "")));
  EXPECT_EQ(findings(file), Rules{});
  EXPECT_EQ(default_of(file, {0x2000, 0}), "7");
  EXPECT_EQ(file.dictionary.object(0x2000)->entries.size(), 4U);
  EXPECT_EQ(file.dictionary.find({0x2000, 2})->type, DataType::u32);
  EXPECT_EQ(file.dictionary.object(0x2000)->entries[1].address.sub, 1);
  EXPECT_EQ(file.dictionary.object(0x2000)->entries[3].address.sub, 3);
}

TEST(EdsCompact, MakesAHundredThousandEntriesInAllAndNotOneMore) {
  std::string text = variable("1000", "7", "") + variable("1001", "5", "ObjectType=8\nCompactSubObj=1");
  for (int i = 0; i < 392; ++i)
    text += variable(fmt::format("{:04X}", 0x2000 + i), "5", "ObjectType=8\nCompactSubObj=254");
  const auto more = [&](const std::string& count) {
    return read(text + variable("3000", "5", "ObjectType=8\nCompactSubObj=" + count));
  };
  EXPECT_EQ(findings(more("38")), Rules{});
  EXPECT_EQ(more("38").dictionary.entry_count(), 100'002U);
  EXPECT_EQ(findings(more("39")), Rules{"2369:15 too-many-entries"});
}

TEST(EdsCompact, CountsTheEntriesItMakesAndNotThoseThatAreThere) {
  std::string text;
  for (int index = 0x2000; index < 0x2000 + 199; ++index) {
    text += variable(fmt::format("{:04X}", index), "5", "ObjectType=8\nCompactSubObj=254");
    for (int sub = 1; sub <= 252; ++sub) text += variable(fmt::format("{:04X}sub{:X}", index, sub), "5", "");
  }
  EXPECT_EQ(findings(read(text)), Rules{});
}

std::string device(std::string_view lines) { return "[DeviceInfo]\n" + std::string(lines) + kGood; }

TEST(EdsCompactPdo, HasTheEntriesThatTheMaskNames) {
  const auto file = read(device("CompactPDO=0xFF\nNrOfRXPDO=1\nNrOfTXPDO=1\n"));
  struct Row {
    const char* name;
    DataType type;
  };
  const Row rows[] = {{"Highest sub-index supported", DataType::u8},
                      {"COB-ID", DataType::u32},
                      {"Transmission type", DataType::u8},
                      {"Inhibit time", DataType::u16},
                      {"Compatibility entry", DataType::u8},
                      {"Event timer", DataType::u16},
                      {"SYNC start value", DataType::u8}};
  for (const auto index : {0x1400, 0x1800}) {
    const auto* object = file.dictionary.object(static_cast<std::uint16_t>(index));
    ASSERT_NE(object, nullptr);
    EXPECT_EQ(object->name,
              index == 0x1400 ? "RPDO communication parameter" : "TPDO communication parameter");
    EXPECT_EQ(object->code, ObjectCode::record);
    ASSERT_EQ(object->entries.size(), std::size(rows));
    for (std::uint8_t sub = 0; sub < std::size(rows); ++sub) {
      EXPECT_EQ(object->entries[sub].address, (ObjectAddress{object->index, sub}));
      EXPECT_EQ(object->entries[sub].name, rows[sub].name);
      EXPECT_EQ(object->entries[sub].type, rows[sub].type);
      EXPECT_EQ(object->entries[sub].access, sub == 0 ? Access::constant : Access::rw);
    }
    EXPECT_EQ(default_of(file, {object->index, 0}), "6");
    EXPECT_EQ(default_of(file, {object->index, 2}), "none");
  }
}

TEST(EdsCompactPdo, MayHaveNoEntryAtAll) {
  const auto file = read(device("CompactPDO=0x40\nNrOfRXPDO=1\n"));
  EXPECT_EQ(default_of(file, {0x1400, 0}), "0");
  EXPECT_EQ(file.dictionary.object(0x1400)->entries.size(), 1U);
}

TEST(EdsCompactPdo, MayLackTheCobId) {
  const auto file = read(device("CompactPDO=2\nNrOfRXPDO=1\n"));
  EXPECT_EQ(default_of(file, {0x1400, 0}), "2");
  EXPECT_EQ(file.dictionary.find({0x1400, 1}), nullptr);
  EXPECT_EQ(file.dictionary.find({0x1400, 2})->name, "Transmission type");
  EXPECT_EQ(default_of(file, {0x1400, 2}), "none");
}

TEST(EdsCompactPdo, HasThePredefinedCobIdsOfTheFirstFour) {
  const auto file = read(device("CompactPDO=1\nNrOfRXPDO=5\nNrOfTXPDO=5\n"));
  const char* expected[] = {"517", "389",  "773",  "645",        "1029",
                            "901", "1285", "1157", "2147483648", "2147483648"};
  for (std::uint16_t number = 0; number < 5; ++number) {
    EXPECT_EQ(default_of(file, {static_cast<std::uint16_t>(0x1400 + number), 1}), expected[2 * number]);
    EXPECT_EQ(default_of(file, {static_cast<std::uint16_t>(0x1800 + number), 1}), expected[2 * number + 1]);
  }
  EXPECT_EQ(file.dictionary.object(0x1405), nullptr);
}

TEST(EdsCompactPdo, HasAsManyMappingsAsTheGranularityAllows) {
  const std::pair<const char*, std::size_t> rows[] = {{"", 8},  {"0", 8},  {"1", 64},
                                                      {"8", 8}, {"16", 4}, {"64", 1}};
  for (const auto& row : rows) {
    const auto file = read(device("CompactPDO=1\nNrOfTXPDO=1\nGranularity=" + std::string(row.first) + "\n"));
    ASSERT_NE(file.dictionary.object(0x1A00), nullptr);
    const auto& object = *file.dictionary.object(0x1A00);
    EXPECT_EQ(object.name, "TPDO mapping parameter");
    EXPECT_EQ(object.code, ObjectCode::record);
    ASSERT_EQ(object.entries.size(), row.second + 1) << row.first;
    EXPECT_EQ(default_of(file, {0x1A00, 0}), "0");
    EXPECT_EQ(object.entries[0].access, Access::rw);
    EXPECT_EQ(object.entries[1].name, "Mapping entry 1");
    EXPECT_EQ(object.entries[1].access, Access::rw);
    EXPECT_EQ(object.entries[1].type, DataType::u32);
    EXPECT_EQ(object.entries[1].address, (ObjectAddress{0x1A00, 1}));
    EXPECT_EQ(default_of(file, {0x1A00, 1}), "0");
  }
}

TEST(EdsCompactPdo, AreAtMost512OfAKind) {
  const auto most = read(device("CompactPDO=1\nNrOfRXPDO=512\n"));
  EXPECT_EQ(findings(most), Rules{});
  EXPECT_NE(most.dictionary.object(0x15FF), nullptr);
  EXPECT_NE(most.dictionary.object(0x17FF), nullptr);
  EXPECT_EQ(most.dictionary.object(0x1800), nullptr);
  const auto file = read(device("CompactPDO=256\nNrOfRXPDO=1\n"));
  EXPECT_EQ(findings(file), Rules{"2:12 bad-number"});
  EXPECT_EQ(file.dictionary.object(0x1400), nullptr);
  EXPECT_EQ(findings(read(device("CompactPDO=1\nNrOfRXPDO=513\nGranularity=65\n"))),
            (Rules{"3:11 bad-number", "4:13 bad-number"}));
  EXPECT_EQ(read(device("NrOfRXPDO=1\n")).dictionary.object(0x1400), nullptr);
  EXPECT_EQ(read(device("CompactPDO=0\nNrOfRXPDO=1\n")).dictionary.object(0x1400), nullptr);
}

TEST(EdsCompactPdo, FillTheGapsBetweenThoseThatAreListed) {
  const auto file =
      read(device("CompactPDO=1\nNrOfRXPDO=3\n") + variable("1401", "7", "") + variable("1600", "7", ""));
  EXPECT_EQ(file.dictionary.object(0x1400), nullptr);
  EXPECT_EQ(file.dictionary.object(0x1601), nullptr);
  EXPECT_NE(file.dictionary.object(0x1402), nullptr);
  EXPECT_NE(file.dictionary.object(0x1602), nullptr);
  EXPECT_EQ(file.dictionary.object(0x1403), nullptr);
  const auto enough =
      read(device("CompactPDO=1\nNrOfRXPDO=1\n") + variable("1400", "7", "") + variable("1402", "7", ""));
  EXPECT_EQ(enough.dictionary.object(0x1401), nullptr);
  const auto last = read(device("CompactPDO=1\nNrOfRXPDO=1\n") + variable("15FF", "7", ""));
  EXPECT_EQ(last.dictionary.object(0x1400), nullptr);
}

}  // namespace
}  // namespace servoctl::od
