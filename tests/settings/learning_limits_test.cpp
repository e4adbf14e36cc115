// When `eds learn` does not scan a drive, or ends: axes with power, alarms, restarts, answers that are none.
#include "settings/learning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "base/file.hpp"
#include "learning_world.hpp"
#include "settings/scan_file.hpp"
#include "tests/show/audiences.hpp"

namespace servoctl::settings {
namespace {

constexpr std::size_t kTooLong = 3'000'000;

class LearningLimitsTest : public LearningWorld {};

TEST_F(LearningLimitsTest, AnEmergencyStopsTheScanAndItsReadsAreLeftOutOfTheNext) {
  node->alarming = {{0x2A00, 0}};
  const LearnOptions short_range{.ranges = {{0x29F0, 0x2A30}}};
  const auto ended = learn(short_range);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Errc::refused);
  EXPECT_NE(ended.error().message.text().find("EMCY 8130h"), std::string::npos)
      << ended.error().message.text();
  EXPECT_NE(ended.error().hint.text().find("leaves out 2A00h to 2A0Fh"), std::string::npos)
      << ended.error().hint.text();
  EXPECT_TRUE(std::filesystem::exists(scan_file(file)));
  begin_anew();
  node->objects.values[{0x2A20, 0}] = {1, 0};
  node->alarming = {{0x2A00, 0}};
  const auto done = learn(short_range);
  ASSERT_TRUE(done) << done.error().message.text();
  EXPECT_NE(report::to_json(report::Value(*done)).find("an EMCY came"), std::string::npos);
  const auto written = read_file(file);
  ASSERT_TRUE(written);
  EXPECT_NE(written->find("Indexes not read: 2A00-2A0F."), std::string::npos)
      << "whoever has the file alone knows it";
  EXPECT_NE(desk.notices.front().text().find("goes on at 32 of 65 indexes"), std::string::npos)
      << desk.notices.front().text();
}

TEST_F(LearningLimitsTest, WhatWasNotReadIsNotSaidToBeMissing) {
  node->alarming = {{0x2A00, 0}};
  const LearnOptions short_range{.ranges = {{0x29F0, 0x2A10}}};
  ASSERT_FALSE(learn(short_range));
  begin_anew();
  node->alarming = {{0x2A00, 0}};
  const auto done = learn(short_range);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.text().find("indexes 2A00-2A0F were not read"), std::string::npos)
      << done.error().message.text();
}

TEST_F(LearningLimitsTest, AnEmergencyToTheStoredEdsEndsIt) {
  node->alarming = {{0x1021, 0}};
  const auto ended = learn();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Errc::refused);
}

TEST_F(LearningLimitsTest, AFurtherAxisWithPowerIsNotScannedWhateverTheRange) {
  node->objects.values[{0x7841, 0}] = {0x37, 0x02};
  for (const auto& options : {LearnOptions{}, LearnOptions{.ranges = {{0x2000, 0x2010}}, .scans = true}}) {
    node->asked.clear();
    const auto refused = learn(options);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::refused);
    for (const auto object : node->asked) EXPECT_TRUE(object.index != 0x1021 && object.index != 0x2000);
  }
}

TEST_F(LearningLimitsTest, AnAxisThatGetsPowerMeanwhileEndsTheScan) {
  node->objects.values[{0x6841, 0}] = {0x50, 0x02};
  node->on_request[{0x2A00, 0}] = [&] { node->objects.values[{0x6841, 0}] = {0x37, 0x02}; };
  const auto ended = learn();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Errc::refused);
  for (const auto object : node->asked) EXPECT_TRUE(object.index < 0x2A10 || object.index > 0x4000);
  EXPECT_NE(content_of(scan_file(file)).find("done 6656\n"), std::string::npos) << "2A00h is not done";
}

TEST_F(LearningLimitsTest, ARestartOrAnotherIdentityEndsTheScan) {
  node->booting = {{0x2A00, 0}};
  const auto ended = learn();
  ASSERT_FALSE(ended);
  EXPECT_NE(ended.error().message.text().find("restarted"), std::string::npos)
      << ended.error().message.text();
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

TEST_F(LearningLimitsTest, DespiteAlarmsAsksForEveryDrive) {
  show::Unwilling nobody;
  desk = {};
  desk.session = &*node->session;
  desk.standard = &standard;
  desk.audience = &nobody;
  EXPECT_FALSE(learn_sheet(desk, 1, file, {.despite_alarms = true}));
  EXPECT_TRUE(std::none_of(node->asked.begin(), node->asked.end(),
                           [](auto object) { return object.index >= 0x2000 && object.index < 0x6000; }));
}

TEST_F(LearningLimitsTest, ADriveThatAnswersEverythingIsNotScanned) {
  node->objects.answers_all = true;
  const auto refused = learn();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::refused);
  EXPECT_LT(node->requests, 100U);
}

TEST_F(LearningLimitsTest, ManySilentIndexesEndTheScan) {
  node->silent_from = 0x2F00;
  const auto ended = learn({.ranges = {{0x2E00, 0x2FFF}}, .scans = true});
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Errc::timeout);
  EXPECT_NE(ended.error().message.text().find("1000h"), std::string::npos) << ended.error().message.text();
  EXPECT_TRUE(std::filesystem::exists(scan_file(file)));
}

TEST_F(LearningLimitsTest, ADriveThatIsSilentAboutWhatItLacksIsNotScanned) {
  node->silent_from = 0x2000;
  node->silent_to = 0x9FFF;
  const auto ended = learn();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Errc::timeout);
  EXPECT_LT(node->requests, 60U) << "that costs seconds, not hours";
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST_F(LearningLimitsTest, WhatIsSentWithoutEndIsGivenUpAndLeftOut) {
  for (const unsigned bytes : {7U, 0U}) {
    begin_anew();
    node->objects.values[{0x2F02, 0}] = {1, 2};
    node->endless = {{{0x2F00, 0}, bytes}};
    node->objects.values[{0x2F01, 0}] = Bytes(kTooLong, 1);
    const auto done = learn({.ranges = {{0x1000, 0x1018}, {0x2F00, 0x2F08}}, .scans = true});
    ASSERT_TRUE(done) << done.error().message.text();
    EXPECT_LT(node->requests, kTooLong / 7) << "requests for segments";
    const auto json = report::to_json(report::Value(*done));
    EXPECT_NE(json.find(R"("left_out":[{"index":12032,"sub":0,)"), std::string::npos) << json;
    EXPECT_NE(json.find(R"({"index":12033,"sub":0,)"), std::string::npos) << json;
    const auto sheet = od::read_eds(content_of(file), "drive.eds").value();
    EXPECT_NE(sheet.dictionary.find({0x2F02, 0}), nullptr) << "what follows is read";
  }
}

TEST_F(LearningLimitsTest, AStoredEdsWithoutEndIsNotUsed) {
  node->endless = {{{0x1021, 0}, 7}};
  const auto done = learn({});
  ASSERT_TRUE(done) << done.error().message.text();
  EXPECT_NE(desk.notices.front().text().find("it sends more than 4194304 bytes"), std::string::npos)
      << desk.notices.front().text();
}

TEST_F(LearningLimitsTest, TheReactionToAnAlarmOfTheScanIsAwaited) {
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
      EXPECT_NE(desk.notices.back().text().find("may be in fault"), std::string::npos)
          << desk.notices.back().text();
      continue;
    }
    EXPECT_NE(done.error().message.text().find("still reacts to a fault"), std::string::npos)
        << done.error().message.text();
    EXPECT_EQ(std::count(node->asked.begin(), node->asked.end(), ObjectAddress{0x2A10, 0}), 0);
  }
}

TEST_F(LearningLimitsTest, ADriveNobodyKnowsRaisesOneAlarmAndIsReadOnOnlyIfThatIsWanted) {
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

TEST_F(LearningLimitsTest, AnEnabledDriveIsNotScanned) {
  node->objects.values[{0x6041, 0}] = {0x37, 0x02};
  const auto refused = learn();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::refused);
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace servoctl::settings
