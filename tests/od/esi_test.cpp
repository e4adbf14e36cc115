#include <gtest/gtest.h>

#include <filesystem>

#include "base/file.hpp"
#include "od/data_sheet.hpp"
#include "tests/od/esi_support.hpp"
#include "tests/source_dir.hpp"

using namespace servoctl;
using namespace servoctl::od;

namespace {

EsiFile p20() {
  const auto text = read_file(std::filesystem::path(source_dir()) / "tests/cli/data/p20.xml");
  return text ? read_good(*text) : EsiFile{};
}

std::uint64_t number(const std::optional<NodeValue>& value) {
  return value ? std::get<std::uint64_t>(value->value) : ~std::uint64_t{0};
}

}  // namespace

TEST(Esi, TellsWhatAMasterKnowsTheDeviceBy) {
  const auto file = p20();
  EXPECT_EQ(file.device.type, "P20");
  EXPECT_EQ(file.device.name, "P20 servo drive");
  EXPECT_EQ(file.device.group, "Servo drives");
  EXPECT_EQ(file.sheet.device.vendor_name, "Muster Drives");
  EXPECT_EQ(file.sheet.device.vendor_number, 0xFABU);
  EXPECT_EQ(file.sheet.device.product_number, 0x2000U);
  EXPECT_EQ(file.sheet.device.revision_number, 0x30001U);
  EXPECT_TRUE(file.sheet.ethercat);
  EXPECT_TRUE(file.sheet.diagnostics.empty());
}

TEST(Esi, ReadsDataLowByteFirstAndValuesAsNumbers) {
  const auto file = p20();
  EXPECT_EQ(number(file.sheet.dictionary.find({0x1000, 0})->default_value), 0x20192U);
  EXPECT_EQ(number(file.sheet.dictionary.find({0x1018, 1})->default_value), 0xFABU);
  const auto* delay = file.sheet.dictionary.find({0x2000, 3});
  ASSERT_NE(delay, nullptr);
  EXPECT_EQ(number(delay->default_value), 300U);
  EXPECT_EQ(number(delay->high), 1000U);
  EXPECT_EQ(delay->unit, "ms");
  EXPECT_EQ(delay->scale, 1);
  const auto* name = file.sheet.dictionary.find({0x1008, 0});
  EXPECT_EQ(std::get<std::string>(name->default_value->value), "P20");
}

TEST(Esi, NamesAndLabelsAreTakenInBothLanguages) {
  const auto file = p20();
  const auto* brake = file.sheet.dictionary.find({0x2000, 1});
  ASSERT_NE(brake, nullptr);
  EXPECT_EQ(brake->name, "Holding brake");
  EXPECT_EQ(brake->name_zh, "抱闸状态");
  ASSERT_EQ(brake->labels.size(), 2U);
  EXPECT_EQ(brake->labels[1].value, 1);
  EXPECT_EQ(brake->labels[1].label, "open");
  EXPECT_EQ(brake->labels[1].label_zh, "松闸");
}

TEST(Esi, WhereAnEntryMayBeWrittenIsItsNote) {
  const auto file = p20();
  const auto* brake = file.sheet.dictionary.find({0x2000, 1});
  EXPECT_EQ(brake->access, Access::rw);
  EXPECT_EQ(brake->note, "can be written in PRE-OP only");
  EXPECT_EQ(brake->note_zh, "仅可在 PRE-OP 状态下写入");
}

TEST(Esi, AnArrayHasAnEntryForEachOfItsElements) {
  const auto file = p20();
  const auto* object = file.sheet.dictionary.object(0x2001);
  ASSERT_NE(object, nullptr);
  EXPECT_EQ(object->code, ObjectCode::array);
  ASSERT_EQ(object->entries.size(), 4U);
  EXPECT_EQ(object->entries[2].name, "Preset speed 2");
  EXPECT_EQ(object->entries[2].type, DataType::i16);
  EXPECT_EQ(std::get<std::int64_t>(object->entries[2].default_value->value), -100);
  EXPECT_EQ(object->entries[3].name, "Preset speed 3");
  EXPECT_EQ(object->entries[3].name_zh, "预设速度 3");
  EXPECT_FALSE(object->entries[3].default_value);
}

TEST(Esi, APdoTellsHowItsObjectsAreMappedAndWhichObjectMapsThem) {
  const auto file = p20();
  EXPECT_EQ(file.sheet.dictionary.find({0x6060, 0})->pdo, PdoMapping::rpdo);
  const auto* second = file.sheet.dictionary.find({0x1600, 2});
  ASSERT_NE(second, nullptr);
  EXPECT_EQ(number(second->default_value), 0x6060'0008U);
  EXPECT_EQ(second->access, Access::ro);
  EXPECT_EQ(file.sheet.dictionary.find({0x1A00, 1})->access, Access::rw);
  EXPECT_EQ(number(file.sheet.dictionary.find({0x1C12, 1})->default_value), 0x1600U);
  EXPECT_EQ(number(file.sheet.dictionary.find({0x1C13, 0})->default_value), 1U);
}

TEST(Esi, TellsMailboxesPdosAndSynchronisation) {
  const auto file = p20();
  const auto* mailbox = file.layout.find(EsiSyncManager::Use::mailbox_in);
  ASSERT_NE(mailbox, nullptr);
  EXPECT_EQ(mailbox->start, 0x1400U);
  EXPECT_EQ(mailbox->size, 128U);
  EXPECT_EQ(mailbox->control, 0x22U);
  EXPECT_EQ(file.layout.fmmus.size(), 2U);
  ASSERT_EQ(file.layout.pdos.size(), 2U);
  EXPECT_TRUE(file.layout.pdos[0].fixed);
  EXPECT_EQ(file.layout.pdos[0].bits(), 32U);
  EXPECT_EQ(file.layout.pdos[0].sync_manager, 2);
  EXPECT_TRUE(file.layout.sdo_info);
  EXPECT_FALSE(file.layout.complete_access);
  ASSERT_EQ(file.layout.modes.size(), 2U);
  EXPECT_EQ(file.layout.modes[1].assign_activate, 0x300U);
  EXPECT_EQ(file.layout.eeprom_bytes, 2048U);
}

TEST(Esi, WithoutADictionaryTheMappedObjectsAreWhatIsKnown) {
  const auto file = read_good(
      esi_text("<RxPdo Sm=\"2\"><Index>#x1600</Index><Entry><Index>#x7010</Index><SubIndex>2</SubIndex>"
               "<BitLen>16</BitLen><Name>Speed</Name><DataType>INT</DataType></Entry></RxPdo>"));
  const auto* entry = file.sheet.dictionary.find({0x7010, 2});
  ASSERT_NE(entry, nullptr);
  EXPECT_EQ(entry->name, "Speed");
  EXPECT_EQ(entry->type, DataType::i16);
  EXPECT_EQ(entry->access, Access::rw);
  EXPECT_EQ(entry->pdo, PdoMapping::rpdo);
  EXPECT_NE(finding(file, "no-dictionary"), nullptr);
  EXPECT_EQ(file.sheet.dictionary.object(0x1600), nullptr) << "without CoE nobody can read a mapping";
}

TEST(Esi, OfSeveralDevicesOneIsNamedByNumberNameOrIdentity) {
  const auto text = read_file(std::filesystem::path(source_dir()) / "tests/cli/data/cells.xml");
  ASSERT_TRUE(text);
  EXPECT_EQ(read_good(*text, "2").device.name, "Load cell 2");
  EXPECT_EQ(read_good(*text, "load cell 1").number, 1U);
  EXPECT_EQ(read_good(*text, "0x3000:2").number, 2U);
  const auto unclear = read_esi(*text, "cells.xml", "#x3000");
  ASSERT_FALSE(unclear);
  EXPECT_EQ(unclear.error().code, Errc::usage);
  EXPECT_EQ(unclear.error().message.text(), "cells.xml has 2 devices '#x3000'");
  const auto none = read_esi(*text, "cells.xml");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message.text(), "cells.xml describes 2 devices: which one?");
  EXPECT_NE(none.error().hint.text().find("#2 Load cell 2 (product code 0x00003000, revision 0x00000002)"),
            std::string::npos);
  EXPECT_FALSE(read_esi(*text, "cells.xml", "3"));
}

TEST(Esi, AllDevicesOfAFileAreReadWhereNoneIsNamed) {
  const auto text = read_file(std::filesystem::path(source_dir()) / "tests/cli/data/cells.xml");
  ASSERT_TRUE(text);
  const auto all = read_all_esi(*text, "cells.xml");
  ASSERT_TRUE(all);
  ASSERT_EQ(all->size(), 2U);
  EXPECT_EQ((*all)[1].device.name, "Load cell 2");
}

TEST(Esi, TheNameOfASheetEndsInItsDevice) {
  EXPECT_EQ(sheet_name("a/P20.XML#2").path, "a/P20.XML");
  EXPECT_EQ(sheet_name("a/P20.XML#2").device, "2");
  EXPECT_EQ(sheet_name("a#1/p20.eds").path, "a#1/p20.eds");
  EXPECT_TRUE(sheet_name("p20.xml").device.empty());
}

TEST(Esi, ASheetIsReadByWhatItIsNotByItsName) {
  const auto esi = read_data_sheet(esi_objects(esi_object("#x2000", "UINT")), "p20.eds");
  ASSERT_TRUE(esi);
  EXPECT_TRUE(esi->ethercat);
  const auto eds = read_data_sheet("[2000]\nParameterName=A\nDataType=5\nAccessType=ro\n", "p20.xml");
  ASSERT_TRUE(eds);
  EXPECT_FALSE(eds->ethercat);
}
