// An EDS made from the answers of a drive over CAN: what `eds learn` finds, and when it stops.
#include "settings/learning.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "base/file.hpp"
#include "lying_node.hpp"
#include "od/eds_writer.hpp"
#include "od/learned_mark.hpp"
#include "settings/dictionary_check.hpp"
#include "settings/scan_file.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::settings {
namespace {

constexpr std::size_t kTooLong = 3'000'000;

std::string content_of(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

class LearningTest : public testing::Test {
 protected:
  LearningTest()
      : standard(drive::load_profile("cia402", kFolders).value()),
        family(drive::load_profile("gsd600", kFolders).value()),
        folder(std::filesystem::temp_directory_path() / fmt::format("servoctl-learn-{}", ::getpid())),
        file(folder / "drive.eds") {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    ::setenv("SOURCE_DATE_EPOCH", "1795000000", 1);
    begin_anew();
  }
  ~LearningTest() override { std::filesystem::remove_all(folder); }

  /// The same drive, and another run of the program.
  void begin_anew() {
    node = std::make_unique<LyingNode>(family.dictionary);
    for (std::uint8_t sub = 1; sub <= 4; ++sub) node->objects.values[{0x1018, sub}] = {sub, 1, 0, 0};
  }

  Result<report::Record> learn(const LearnOptions& options = {}) {
    desk = {};
    desk.session = &*node->session;
    desk.standard = &standard;
    return learn_sheet(desk, 1, file, options);
  }
  od::EdsFile learned(const LearnOptions& options = {}) {
    const auto done = learn(options);
    EXPECT_TRUE(done) << done.error().message;
    auto out = od::read_eds(content_of(file), "drive.eds");
    EXPECT_TRUE(out);
    EXPECT_EQ(out->error_count() + out->warning_count(), 0U);
    EXPECT_FALSE(std::filesystem::exists(scan_file(file)));
    EXPECT_TRUE(node->objects.writes.empty());
    return std::move(*out);
  }

  drive::Profile standard;
  drive::Profile family;
  std::filesystem::path folder;
  std::filesystem::path file;
  std::unique_ptr<LyingNode> node;
  show::Desk desk;
};

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
  ASSERT_TRUE(check) << check.error().message;
  for (const auto& found : check->findings)
    ADD_FAILURE() << to_string(found.object) << " " << name(found.difference) << " " << found.file << " "
                  << found.drive;
}

TEST_F(LearningTest, AnInterruptedScanGoesOnWhereItStopped) {
  learned();
  const auto whole = content_of(file);
  const auto requests = node->requests;
  std::filesystem::remove(file);
  for (const std::size_t share : {4U, 2U}) {
    begin_anew();
    node->dies_after = requests / share;
    const auto ended = learn();
    ASSERT_FALSE(ended);
    EXPECT_EQ(ended.error().code, Errc::timeout) << ended.error().message;
    EXPECT_TRUE(std::filesystem::exists(scan_file(file)));
    EXPECT_FALSE(std::filesystem::exists(file));
    ASSERT_FALSE(desk.notices.empty());
    EXPECT_NE(desk.notices.back().find("goes on from there"), std::string::npos);
  }
  begin_anew();
  learned();
  EXPECT_EQ(content_of(file), whole);
  EXPECT_LT(node->requests, requests / 2);
}

TEST_F(LearningTest, TheScanOfAnotherDriveIsNotContinued) {
  const auto refuses = [&](const LearnOptions& options = {}) {
    const auto other = learn(options);
    return !other && other.error().code == Errc::refused;
  };
  for (const ObjectAddress object : {ObjectAddress{0x1018, 4}, ObjectAddress{0x1018, 3}}) {
    begin_anew();
    node->dies_after = 5000;
    ASSERT_FALSE(learn());
    begin_anew();
    node->objects.values[object] = {9, 9, 9, 9};
    EXPECT_TRUE(refuses()) << to_string(object);
    std::filesystem::remove(scan_file(file));
  }
  node->dies_after = 5000;
  begin_anew();
  node->dies_after = 5000;
  ASSERT_FALSE(learn());
  begin_anew();
  EXPECT_TRUE(refuses({.ranges = {{0x2000, 0x2010}}}));
  std::filesystem::remove(scan_file(file));
  node->dies_after = node->requests + 2000;
  ASSERT_FALSE(learn({.ranges = {{0x2000, 0x2F00}}}));
  begin_anew();
  EXPECT_TRUE(refuses()) << "the ranges of no --range are others";
  std::ofstream(scan_file(file)) << "a file of somebody\n";
  EXPECT_TRUE(refuses());
  EXPECT_EQ(content_of(scan_file(file)), "a file of somebody\n");
}

TEST_F(LearningTest, AScanThatWasCutOrHasNoSerialNumberBeginsAnew) {
  for (const bool has_serial : {true, false}) {
    begin_anew();
    if (!has_serial) node->objects.values[{0x1018, 4}] = {0, 0, 0, 0};
    node->dies_after = 5000;
    ASSERT_FALSE(learn());
    auto text = content_of(scan_file(file));
    if (has_serial) std::ofstream(scan_file(file)) << text.substr(0, text.size() / 2);
    begin_anew();
    if (!has_serial) node->objects.values[{0x1018, 4}] = {0, 0, 0, 0};
    ASSERT_TRUE(learn());
    EXPECT_NE(desk.notices.front().find("begins anew"), std::string::npos) << desk.notices.front();
    std::filesystem::remove(file);
  }
}

TEST_F(LearningTest, AnEmergencyStopsTheScanAndItsReadsAreLeftOutOfTheNext) {
  node->alarming = {{0x2A00, 0}};
  const LearnOptions short_range{.ranges = {{0x29F0, 0x2A30}}};
  const auto ended = learn(short_range);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Errc::refused);
  EXPECT_NE(ended.error().message.find("EMCY 8130h"), std::string::npos) << ended.error().message;
  EXPECT_NE(ended.error().hint.find("leaves out 2A00h to 2A0Fh"), std::string::npos) << ended.error().hint;
  EXPECT_TRUE(std::filesystem::exists(scan_file(file)));
  begin_anew();
  node->objects.values[{0x2A20, 0}] = {1, 0};
  node->alarming = {{0x2A00, 0}};
  const auto done = learn(short_range);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_NE(report::to_json(report::Value(*done)).find("an EMCY came"), std::string::npos);
  const auto written = read_file(file);
  ASSERT_TRUE(written);
  EXPECT_NE(written->find("Indexes not read: 2A00-2A0F."), std::string::npos)
      << "whoever has the file alone knows it";
  EXPECT_NE(desk.notices.front().find("goes on at 32 of 65 indexes"), std::string::npos)
      << desk.notices.front();
}

TEST_F(LearningTest, WhatWasNotReadIsNotSaidToBeMissing) {
  node->alarming = {{0x2A00, 0}};
  const LearnOptions short_range{.ranges = {{0x29F0, 0x2A10}}};
  ASSERT_FALSE(learn(short_range));
  begin_anew();
  node->alarming = {{0x2A00, 0}};
  const auto done = learn(short_range);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("indexes 2A00-2A0F were not read"), std::string::npos)
      << done.error().message;
}

TEST_F(LearningTest, AnEmergencyToTheStoredEdsEndsIt) {
  node->alarming = {{0x1021, 0}};
  const auto ended = learn();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Errc::refused);
}

TEST_F(LearningTest, AFurtherAxisWithPowerIsNotScannedWhateverTheRange) {
  node->objects.values[{0x7841, 0}] = {0x37, 0x02};
  for (const auto& options : {LearnOptions{}, LearnOptions{.ranges = {{0x2000, 0x2010}}, .scans = true}}) {
    node->asked.clear();
    const auto refused = learn(options);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::refused);
    for (const auto object : node->asked) EXPECT_TRUE(object.index != 0x1021 && object.index != 0x2000);
  }
}

TEST_F(LearningTest, AnAxisThatGetsPowerMeanwhileEndsTheScan) {
  node->objects.values[{0x6841, 0}] = {0x50, 0x02};
  node->on_request[{0x2A00, 0}] = [&] { node->objects.values[{0x6841, 0}] = {0x37, 0x02}; };
  const auto ended = learn();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Errc::refused);
  for (const auto object : node->asked) EXPECT_TRUE(object.index < 0x2A10 || object.index > 0x4000);
  EXPECT_NE(content_of(scan_file(file)).find("done 6656\n"), std::string::npos) << "2A00h is not done";
}

TEST_F(LearningTest, ARestartOrAnotherIdentityEndsTheScan) {
  node->booting = {{0x2A00, 0}};
  const auto ended = learn();
  ASSERT_FALSE(ended);
  EXPECT_NE(ended.error().message.find("restarted"), std::string::npos) << ended.error().message;
  EXPECT_TRUE(std::filesystem::exists(scan_file(file)));
  std::filesystem::remove(scan_file(file));
  begin_anew();
  node->on_request[{0x2A00, 0}] = [&] { node->objects.values[{0x1018, 4}] = {7, 7, 7, 7}; };
  const auto swapped = learn();
  ASSERT_FALSE(swapped);
  EXPECT_EQ(swapped.error().code, Errc::refused);
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_TRUE(std::filesystem::exists(scan_file(file)));
}

TEST_F(LearningTest, DespiteAlarmsAsksForEveryDrive) {
  show::Unwilling nobody;
  desk = {};
  desk.session = &*node->session;
  desk.standard = &standard;
  desk.audience = &nobody;
  EXPECT_FALSE(learn_sheet(desk, 1, file, {.despite_alarms = true}));
  EXPECT_TRUE(std::none_of(node->asked.begin(), node->asked.end(),
                           [](auto object) { return object.index >= 0x2000 && object.index < 0x6000; }));
}

TEST_F(LearningTest, ADriveThatAnswersEverythingIsNotScanned) {
  node->objects.answers_all = true;
  const auto refused = learn();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::refused);
  EXPECT_LT(node->requests, 100U);
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
  ASSERT_TRUE(done) << done.error().message;
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

TEST_F(LearningTest, ManySilentIndexesEndTheScan) {
  node->silent_from = 0x2F00;
  const auto ended = learn({.ranges = {{0x2E00, 0x2FFF}}, .scans = true});
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Errc::timeout);
  EXPECT_NE(ended.error().message.find("1000h"), std::string::npos) << ended.error().message;
  EXPECT_TRUE(std::filesystem::exists(scan_file(file)));
}

TEST_F(LearningTest, ADriveThatIsSilentAboutWhatItLacksIsNotScanned) {
  node->silent_from = 0x2000;
  node->silent_to = 0x9FFF;
  const auto ended = learn();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Errc::timeout);
  EXPECT_LT(node->requests, 60U) << "that costs seconds, not hours";
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST_F(LearningTest, WhatIsSentWithoutEndIsGivenUpAndLeftOut) {
  for (const unsigned bytes : {7U, 0U}) {
    begin_anew();
    node->objects.values[{0x2F02, 0}] = {1, 2};
    node->endless = {{{0x2F00, 0}, bytes}};
    node->objects.values[{0x2F01, 0}] = Bytes(kTooLong, 1);
    const auto done = learn({.ranges = {{0x1000, 0x1018}, {0x2F00, 0x2F08}}, .scans = true});
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_LT(node->requests, kTooLong / 7) << "requests for segments";
    const auto json = report::to_json(report::Value(*done));
    EXPECT_NE(json.find(R"("left_out":[{"index":12032,"sub":0,)"), std::string::npos) << json;
    EXPECT_NE(json.find(R"({"index":12033,"sub":0,)"), std::string::npos) << json;
    const auto sheet = od::read_eds(content_of(file), "drive.eds").value();
    EXPECT_NE(sheet.dictionary.find({0x2F02, 0}), nullptr) << "what follows is read";
  }
}

TEST_F(LearningTest, AStoredEdsWithoutEndIsNotUsed) {
  node->endless = {{{0x1021, 0}, 7}};
  const auto done = learn({});
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_NE(desk.notices.front().find("it sends more than 4194304 bytes"), std::string::npos)
      << desk.notices.front();
}

TEST_F(LearningTest, TheReactionToAnAlarmOfTheScanIsAwaited) {
  show::Willing yes;
  const LearnOptions options{
      .ranges = {{0x1000, 0x1018}, {0x2A00, 0x2A40}}, .scans = true, .despite_alarms = true};
  for (const unsigned looks : {3U, 100'000U}) {
    begin_anew();
    desk = {};
    desk.session = &*node->session;
    desk.audience = &yes;
    unsigned left = looks;
    node->alarming = {{0x2A00, 0}};
    node->on_request[{0x2A00, 0}] = [&] {
      node->asked.clear();
      node->objects.values[{0x6041, 0}] = {0x0F, 0x02};
      node->on_request[{0x6041, 0}] = [&] {
        if (--left == 0) node->objects.values[{0x6041, 0}] = {0x08, 0x02};
      };
    };
    const auto done = learn_sheet(desk, 1, file, options);
    EXPECT_EQ(done.has_value(), looks == 3);
    if (done) {
      EXPECT_NE(desk.notices.back().find("may be in fault"), std::string::npos) << desk.notices.back();
      continue;
    }
    EXPECT_NE(done.error().message.find("still reacts to a fault"), std::string::npos)
        << done.error().message;
    EXPECT_EQ(std::count(node->asked.begin(), node->asked.end(), ObjectAddress{0x2A10, 0}), 0);
  }
}

TEST_F(LearningTest, ADriveNobodyKnowsRaisesOneAlarmAndIsReadOnOnlyIfThatIsWanted) {
  show::Willing yes;
  for (const bool despite : {false, true}) {
    begin_anew();
    desk = {};
    desk.session = &*node->session;
    desk.audience = &yes;
    node->alarming = {{0x6841, 0}, {0x1021, 0}, {0x5E3B, 0}};
    const auto done = learn_sheet(desk, 1, file, {.ranges = {{0x1000, 0x1030}}, .despite_alarms = despite});
    EXPECT_EQ(done.has_value(), despite);
    if (!despite) {
      EXPECT_EQ(done.error().code, Errc::refused);
      EXPECT_EQ(std::count(node->asked.begin(), node->asked.end(), ObjectAddress{0x7041, 0}), 0);
    }
  }
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
  EXPECT_TRUE(od::is_learned(content_of(file)));
  EXPECT_FALSE(od::is_learned(content_of(std::string(source_dir()) + "/eds/dm/dm.eds")));
}

TEST_F(LearningTest, AnEnabledDriveIsNotScanned) {
  node->objects.values[{0x6041, 0}] = {0x37, 0x02};
  const auto refused = learn();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::refused);
  EXPECT_FALSE(std::filesystem::exists(file));
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
  EXPECT_NE(desk.notices.front().find("are no EDS"), std::string::npos) << desk.notices.front();
  node->objects.refusals[{0x1021, 0}] = 0x0800'0021;
  EXPECT_TRUE(learn({.ranges = {{0x1000, 0x1018}}}));
  EXPECT_NE(desk.notices.front().find("(1021h) is not used"), std::string::npos) << desk.notices.front();
}

TEST_F(LearningTest, TheStoredEdsOfAnotherProductIsNotTaken) {
  auto stored = content_of(std::string(source_dir()) + "/eds/vmmore/gsd600.eds");
  stored.replace(stored.find("ProductNumber=0x0"), 17, "ProductNumber=0x9");
  node->objects.values[{0x1021, 0}] = Bytes(stored.begin(), stored.end());
  EXPECT_TRUE(learn({.ranges = {{0x1000, 0x1018}}}));
  EXPECT_NE(content_of(file), stored);
  EXPECT_NE(desk.notices.front().find("another one"), std::string::npos) << desk.notices.front();
}

TEST_F(LearningTest, ObjectsThatRefuseToBeReadAreLeftOutAndTold) {
  node->silent = {{0x2A00, 0}};
  node->objects.values[{0x2A00, 0}] = {0};
  const auto done = learn({.ranges = {{0x1000, 0x1018}, {0x29F0, 0x2A10}}});
  ASSERT_TRUE(done) << done.error().message;
  const auto json = report::to_json(report::Value(*done));
  EXPECT_NE(json.find(R"("left_out":[{"index":10752,"sub":0,"reason":"no answer"}])"), std::string::npos)
      << json;
}

session::ScanState sample_scan() {
  session::ScanState state{.ranges = {{0x2000, 0x2FFF}, {0x6000, 0x67FF}}, .done = 77};
  state.entries = {{{0x2000, 0}, true, 2, {1, 2}},
                   {{0x2000, 0xFE}, false},
                   {{0x2001, 0}, true, 0, {}},
                   {{0x2002, 0}, true, 400, Bytes(session::kScannedBytes, 0xAB)}};
  state.refusals = {{{0x2003, 0}, 0x0800'0022}, {{0x2004, 1}, 0}};
  return state;
}

TEST(ScanFile, ReadsWhatItWrites) {
  const auto state = sample_scan();
  const auto read = read_scan(scan_text("00020192 - - - -", state));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->identity, "00020192 - - - -");
  EXPECT_EQ(read->state.ranges, state.ranges);
  EXPECT_EQ(read->state.done, state.done);
  EXPECT_EQ(read->state.entries, state.entries);
  EXPECT_EQ(read->state.refusals, state.refusals);
}

TEST(ScanFile, WhatIsCutOrContradictsItselfIsNotRead) {
  const auto text = scan_text("x", sample_scan());
  for (std::size_t size = 0; size + 1 < text.size(); ++size)
    EXPECT_FALSE(read_scan(std::string_view(text).substr(0, size))) << size;
  auto lost = text;
  lost.erase(lost.find("2001:0"), lost.find("2002:0") - lost.find("2001:0"));
  EXPECT_FALSE(read_scan(lost)) << "a line less than it says";
  auto twice = sample_scan();
  twice.entries.push_back(twice.entries.front());
  EXPECT_FALSE(read_scan(scan_text("x", twice)));
  auto ahead = sample_scan();
  ahead.entries.push_back({{0x2500, 0}, false});
  EXPECT_FALSE(read_scan(scan_text("x", ahead))) << "that index is not done";
}

TEST(ScanFile, RangesAreInOrderAndNoneTwice) {
  EXPECT_EQ(ranges_text(parse_ranges("6000-67FF, 2000-2fff,1018").value()), "1018-1018,2000-2FFF,6000-67FF");
  EXPECT_EQ(ranges_text(parse_ranges("0x2000-2010h").value()), "2000-2010");
  EXPECT_NE(parse_ranges("2000-2010,").error().message.find("comma"), std::string::npos);
  std::string many = "2000";
  for (int i = 1; i < 16; ++i) many += fmt::format(",20{:02X}", i);
  EXPECT_TRUE(parse_ranges(many));
  EXPECT_FALSE(parse_ranges(many + ",2010"));
  for (const auto* wrong : {"", "0FFF-2000", "2000-1FFF", "9000-A000", "2000-2FFF,2FFF-3000", "abc-xyz"})
    EXPECT_FALSE(parse_ranges(wrong)) << wrong;
}

}  // namespace
}  // namespace servoctl::settings
