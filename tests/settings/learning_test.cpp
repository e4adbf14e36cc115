// An EDS made from the answers of a drive over CAN: what `eds learn` finds.
#include "settings/learning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "learning_world.hpp"
#include "settings/dictionary_check.hpp"
#include "settings/scan_file.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::settings {
namespace {

class LearningTest : public LearningWorld {};

TEST_F(LearningTest, FindsEachObjectWithItsSizeAndWhetherItCanBeRead) {
  const auto sheet = learned();
  for (const auto& [object, bytes] : node->objects.values) {
    const auto* entry = sheet.dictionary.find(object);
    ASSERT_NE(entry, nullptr) << to_string(object);
    const bool readable = !node->objects.write_only.contains(object);
    EXPECT_EQ(od::readable(entry->access), readable) << to_string(object);
    if (const auto size = od::size_of(entry->type); size && readable) {
      EXPECT_EQ(*size, bytes.size()) << to_string(object);
    }
  }
  EXPECT_EQ(sheet.dictionary.entry_count(), node->objects.values.size());
  EXPECT_EQ(sheet.dictionary.find({0x6041, 0})->name, "Statusword");
  EXPECT_EQ(sheet.dictionary.find({0x6060, 0})->access, od::Access::rw);
}

TEST_F(LearningTest, WhatIsLearnedIsTrueOfTheDrive) {
  const auto sheet = learned();
  const auto check = check_dictionary(desk, 1, sheet, {});
  ASSERT_TRUE(check) << check.error().message.text();
  for (const auto& found : check->findings)
    ADD_FAILURE() << to_string(found.object) << " " << name(found.difference) << " " << found.file << " "
                  << found.drive;
}

TEST_F(LearningTest, OnlyTheAnswerOfImprobableIndexesMeansThatThereIsNoObject) {
  node->objects.lacking = 0x0800'0000;
  const LearnOptions options{.ranges = {{0x1000, 0x1018}, {0x2100, 0x2180}}, .scans = true};
  node->objects.remove(0x2100);
  const auto general = learned(options);
  EXPECT_EQ(general.dictionary.object(0x2100), nullptr);
  begin_anew();
  for (std::uint16_t index = 0x2100; index < 0x2130; ++index) {
    node->objects.values[{index, 0}] = {1, 0};
    node->objects.refusals[{index, 0}] = 0x0800'0022;
  }
  const auto done = learn(options);
  ASSERT_TRUE(done) << done.error().message.text();
  const auto json = report::to_json(report::Value(*done));
  for (const unsigned index : {0x2100U, 0x212FU})
    EXPECT_NE(json.find(fmt::format(R"("index":{},"sub":0)", index)), std::string::npos) << index;
  begin_anew();
  node->objects.lacking = 0x0800'0022;
  EXPECT_FALSE(learn(options)) << "which says nothing of the object";
}

TEST_F(LearningTest, SubIndexesAreWalkedPastRefusals) {
  const LearnOptions options{.ranges = {{0x1000, 0x1018}, {0x2F00, 0x2F02}}, .scans = true};
  node->objects.values[{0x2F00, 0}] = {6, 0};
  for (std::uint8_t sub = 1; sub <= 6; ++sub) node->objects.values[{0x2F00, sub}] = {sub, 0};
  node->objects.refusals[{0x2F00, 4}] = 0x0800'0022;
  node->objects.values[{0x2F01, 0}] = {3};
  for (std::uint8_t sub = 1; sub <= 3; ++sub) node->objects.values[{0x2F01, sub}] = {sub, 0};
  node->objects.refusals[{0x2F01, 0}] = 0x0800'0022;
  node->objects.values[{0x2F02, 0}] = {200};
  ASSERT_TRUE(learn(options));
  const auto sheet = od::read_eds(content_of(file), "drive.eds").value();
  for (const int sub : {1, 2, 3, 5, 6})
    EXPECT_NE(sheet.dictionary.find({0x2F00, static_cast<std::uint8_t>(sub)}), nullptr) << sub;
  EXPECT_EQ(sheet.dictionary.find({0x2F00, 4}), nullptr);
  for (const int sub : {1, 2, 3})
    EXPECT_NE(sheet.dictionary.find({0x2F01, static_cast<std::uint8_t>(sub)}), nullptr) << sub;
  EXPECT_EQ(sheet.dictionary.object(0x2F02)->entries.size(), 1U);
  EXPECT_EQ(std::count(node->asked.begin(), node->asked.end(), ObjectAddress{0x2F02, 100}), 0);
}

TEST_F(LearningTest, StandardObjectsOfAnotherSizeKeepSignAndAccess) {
  node->objects.values[{0x606C, 0}] = {1, 0};
  node->objects.values[{0x60FF, 0}] = {1, 0};
  const auto sheet = learned({.ranges = {{0x1000, 0x1018}, {0x6040, 0x60FF}}, .scans = true});
  EXPECT_EQ(sheet.dictionary.find({0x606C, 0})->type, od::DataType::i16);
  EXPECT_EQ(sheet.dictionary.find({0x60FF, 0})->access, od::Access::rw);
  ASSERT_TRUE(learn({.ranges = {{0x6040, 0x60FF}}, .scans = true}));
  const auto part = od::read_eds(content_of(file), "drive.eds").value();
  EXPECT_EQ(part.device.vendor_number, 0x101U) << "of the identity, whatever the range";
}

TEST_F(LearningTest, ADriveThatAlwaysAnswersFourBytesKeepsTheTypesOfTheStandard) {
  for (auto& [object, bytes] : node->objects.values)
    if (bytes.size() < 4) bytes.resize(4);
  node->objects.values[{0x2F00, 0}] = {1, 0, 0, 0};
  const auto sheet =
      learned({.ranges = {{0x1000, 0x1018}, {0x2F00, 0x2F00}, {0x6040, 0x6077}}, .scans = true});
  EXPECT_EQ(sheet.dictionary.find({0x6060, 0})->type, od::DataType::i8);
  EXPECT_NE(sheet.dictionary.object(0x2F00)->name.find("size unknown"), std::string::npos);
}

TEST_F(LearningTest, CobIdsThatFollowTheNodeIdSaySo) {
  node->objects.values[{0x1014, 0}] = {0x81, 0, 0, 0x80};
  node->objects.values[{0x1400, 1}] = {0x01, 0x02, 0, 0};
  node->objects.values[{0x1401, 1}] = {0x02, 0x03, 0, 0};
  node->objects.values[{0x1800, 1}] = {0x81, 0x01, 0, 0xC0};
  node->objects.values[{0x1801, 1}] = {0x81, 0x02, 0, 0xA0};
  node->objects.values[{0x1802, 1}] = {0x01, 0x02, 0, 0};
  const auto sheet = learned({.ranges = {{0x1000, 0x1018}, {0x1200, 0x1200}, {0x1400, 0x1803}}});
  const auto follows = [&](ObjectAddress object, std::uint64_t base) {
    const auto& said = sheet.dictionary.find(object)->default_value;
    return said && said->plus_node_id && said->value == od::Value(base);
  };
  EXPECT_TRUE(follows({0x1014, 0}, 0x8000'0080)) << "with its other bits";
  EXPECT_NE(content_of(file).find("DefaultValue=$NODEID+0x80000080\n"), std::string::npos);
  EXPECT_TRUE(follows({0x1200, 1}, 0x600));
  EXPECT_TRUE(follows({0x1200, 2}, 0x580));
  EXPECT_TRUE(follows({0x1400, 1}, 0x200));
  EXPECT_TRUE(follows({0x1800, 1}, 0xC000'0180));
  for (const ObjectAddress other : {ObjectAddress{0x1401, 1}, {0x1801, 1}, {0x1802, 1}})
    EXPECT_FALSE(sheet.dictionary.find(other)->default_value)
        << to_string(other) << ": of another node, of 29 bits, of another service";
}

TEST_F(LearningTest, NamesOfDrivesAreForDrives) {
  node->objects.values[{0x1000, 0}] = {0x91, 0x01, 3, 0};
  node->objects.remove(0x6041);
  const auto sheet = learned({.ranges = {{0x1000, 0x1018}, {0x6040, 0x6060}}, .scans = true});
  EXPECT_EQ(sheet.dictionary.find({0x6040, 0})->name, "Object 6040h");
  EXPECT_EQ(sheet.dictionary.find({0x6040, 0})->access, od::Access::ro);
  EXPECT_EQ(sheet.dictionary.find({0x1000, 0})->name, "Device type");
}

TEST_F(LearningTest, WhatIsNoFileIsRefusedBeforeTheFirstRead) {
  for (const auto& wrong : {std::filesystem::path(), std::filesystem::path("-"), folder,
                            std::filesystem::path("/dev/full"), folder / "none" / "drive.eds"}) {
    desk = {};
    desk.session = &*node->session;
    EXPECT_FALSE(learn_sheet(desk, 1, wrong, {})) << wrong;
  }
  EXPECT_EQ(node->requests, 0U);
}

TEST_F(LearningTest, AScanIsMarkedAsOne) {
  learned({.ranges = {{0x1000, 0x1018}}, .scans = true});
  EXPECT_TRUE(od::read_eds(content_of(file), "drive.eds").value().learned);
}

TEST_F(LearningTest, OneValueOfADriveThatDoesNotLookAtTheSubIndexIsOne) {
  for (unsigned sub = 0; sub <= 0xFF; ++sub)
    node->objects.values[{0x2F00, static_cast<std::uint8_t>(sub)}] = {5, 0};
  const auto sheet = learned({.ranges = {{0x1000, 0x1018}, {0x2F00, 0x2F10}}});
  ASSERT_NE(sheet.dictionary.object(0x2F00), nullptr);
  EXPECT_EQ(sheet.dictionary.object(0x2F00)->entries.size(), 1U);
}

TEST_F(LearningTest, AStoredEdsIsTakenAsItIs) {
  const auto stored = content_of(std::string(source_dir()) + "/eds/vmmore/gsd600.eds");
  node->objects.values[{0x1021, 0}] = Bytes(stored.begin(), stored.end());
  node->objects.values[{0x1022, 0}] = {0, 0};
  ASSERT_TRUE(learn());
  EXPECT_EQ(content_of(file), stored);
  EXPECT_TRUE(learn({.ranges = {{0x1000, 0x1018}}, .scans = true}));
  EXPECT_NE(content_of(file), stored);
  node->objects.values[{0x1021, 0}] = {'P', 'K', 3, 4, 0, 0};
  EXPECT_TRUE(learn({.ranges = {{0x1000, 0x1018}}}));
  EXPECT_NE(desk.notices.front().text().find("are no EDS"), std::string::npos) << desk.notices.front().text();
  node->objects.refusals[{0x1021, 0}] = 0x0800'0021;
  EXPECT_TRUE(learn({.ranges = {{0x1000, 0x1018}}}));
  EXPECT_NE(desk.notices.front().text().find("(1021h) is not used"), std::string::npos)
      << desk.notices.front().text();
}

TEST_F(LearningTest, TheStoredEdsOfAnotherProductIsNotTaken) {
  auto stored = content_of(std::string(source_dir()) + "/eds/vmmore/gsd600.eds");
  stored.replace(stored.find("ProductNumber=0x0"), 17, "ProductNumber=0x9");
  node->objects.values[{0x1021, 0}] = Bytes(stored.begin(), stored.end());
  EXPECT_TRUE(learn({.ranges = {{0x1000, 0x1018}}}));
  EXPECT_NE(content_of(file), stored);
  EXPECT_NE(desk.notices.front().text().find("another one"), std::string::npos)
      << desk.notices.front().text();
}

TEST_F(LearningTest, ObjectsThatRefuseToBeReadAreLeftOutAndTold) {
  node->silent = {{0x2A00, 0}};
  node->objects.values[{0x2A00, 0}] = {0};
  const auto done = learn({.ranges = {{0x1000, 0x1018}, {0x29F0, 0x2A10}}});
  ASSERT_TRUE(done) << done.error().message.text();
  const auto json = report::to_json(report::Value(*done));
  EXPECT_NE(json.find(R"("left_out":[{"index":10752,"sub":0,"reason":"no answer"}])"), std::string::npos)
      << json;
}

}  // namespace
}  // namespace servoctl::settings
