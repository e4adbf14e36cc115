// What is asked of a drive that may raise an alarm when it is asked for an object that it does not have.
#include "session/wary.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "can/frame.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/access_alarms.hpp"
#include "drive/profile.hpp"
#include "drive/standard_objects.hpp"
#include "session/can_network.hpp"
#include "session/identify.hpp"
#include "session/scan.hpp"
#include "sim/cell.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

constexpr ObjectAddress kNotOfDa200{0x603F, 0};
constexpr ObjectAddress kNoSubOfDa200{0x1018, 7};

class Wary : public testing::Test {
 protected:
  Session open(const std::string& drive) {
    Options options;
    options.drive_folders = [] { return std::span<const std::filesystem::path>(kFolders); };
    options.exchanged = [this](const Exchange& exchange) { asked.push_back(exchange.object); };
    return {sim::open_sim(drive + "@1", kFolders, sim::SimBus::Clock::virtual_time).value(), "sim", options};
  }
  bool was_asked(ObjectAddress object) const {
    return std::find(asked.begin(), asked.end(), object) != asked.end();
  }

  std::vector<ObjectAddress> asked;
  const std::vector<std::uint8_t> nodes{1};
};

std::string warning(std::optional<std::uint32_t> type, std::optional<std::uint32_t> vendor,
                    std::optional<std::uint32_t> product) {
  Identity identity;
  identity.node = 5;
  identity.device_type = type;
  identity.vendor_id = vendor;
  identity.product_code = product;
  return warning_of_details(std::span(&identity, 1), drive::find_families(kFolders));
}

TEST_F(Wary, ScanTellsWhatItFoundBeforeItReadsTheNames) {
  for (const std::string drive : {"ts", "cia402", "da200", "gsd600"}) {
    auto session = open(drive);
    asked.clear();
    bool told = false;
    const auto found = scan(session, nodes, nullptr, [&](std::span<const Identity> identities) {
      told = identities.size() == 1 && identities.front().vendor_id.has_value();
      for (const auto object : asked) EXPECT_TRUE(object.index == 0x1000 || object.index == 0x1018) << drive;
    });
    ASSERT_TRUE(found.has_value());
    EXPECT_TRUE(told) << drive;
    EXPECT_EQ(was_asked(objects::kDeviceName), drive != "da200") << drive << ": da200 has no 1008h";
  }
}

TEST_F(Wary, OneThousandHexOfManyDrivesIsNoKnownFamilyIfAVendorIsNamed) {
  EXPECT_EQ(warning(0x0402'0200, 4, 3), "") << "da200";
  EXPECT_EQ(warning(0x0002'0192, 0, 0), "") << "gsd600";
  EXPECT_NE(warning(0x0002'0192, 0xFB, 0x1234).find("node 5: 1000h and 1018h fit no known family"),
            std::string::npos)
      << "a CiA 402 drive of another maker";
  EXPECT_NE(warning(0x0402'0200, 4, 99), "") << "another drive of the same maker";
  EXPECT_NE(warning(0, std::nullopt, std::nullopt), "");
}

TEST_F(Wary, WhatTheDataLackIsAnsweredWithoutTheDrive) {
  auto session = open("da200");
  consider_numbers(session, nodes);
  asked.clear();
  const SdoRequest requests[] = {{1, kNotOfDa200, {}},
                                 {1, kNoSubOfDa200, {}},
                                 {1, objects::kStatusword, {}},
                                 {1, kNotOfDa200, Bytes{1, 0}}};
  const auto answers = session.transfer(requests);
  EXPECT_EQ(answers[0].error().abort_code, canopen::sdo_abort::kNoObject);
  EXPECT_EQ(answers[1].error().abort_code, canopen::sdo_abort::kNoSubIndex);
  EXPECT_TRUE(answers[2].has_value());
  EXPECT_EQ(answers[3].error().abort_code, canopen::sdo_abort::kNoObject);
  EXPECT_EQ(asked, (std::vector<ObjectAddress>{objects::kStatusword}));
}

TEST_F(Wary, AConfirmedRequestIsSent) {
  auto session = open("da200");
  consider_numbers(session, nodes);
  SdoRequest request{1, kNotOfDa200, {}};
  request.despite_alarm = true;
  EXPECT_FALSE(session.transfer(std::span(&request, 1)).front().has_value());
  EXPECT_TRUE(was_asked(kNotOfDa200));
}

TEST_F(Wary, ADriveWithoutAccessAlarmsIsAskedForEverything) {
  for (const std::string drive : {"gsd600", "ts", "dm", "sv2", "cia402"}) {
    auto session = open(drive);
    consider_numbers(session, nodes);
    EXPECT_EQ(session.wary_of(1), nullptr) << drive;
    EXPECT_TRUE(session.is_considered(1)) << drive;
  }
}

TEST_F(Wary, AFileOfTheUserDecidesWhichObjectsTheDriveHas) {
  auto session = open("da200");
  consider_numbers(session, nodes);
  auto own = drive::load_profile("gsd600", kFolders).value();
  own.family = "newer.eds";
  own.of_file = true;
  be_wary_of_family(session, 1, own);
  EXPECT_EQ(access_alarm(session, 1, kNotOfDa200), "") << "the file has it";
  EXPECT_EQ(access_alarm(session, 1, {0x5FFF, 0}), "Er26-1") << "neither has it";
  consider_numbers(session, nodes);
  EXPECT_EQ(access_alarm(session, 1, kNotOfDa200), "Er26-1") << "the next line names no file";
}

/// A spare alarm costs less than a drive that stays energised.
TEST(AccessAlarms, NoFileKeepsAStopFromTheDrive) {
  drive::Profile without_objects;
  without_objects.rules = drive::load_profile("da200", kFolders).value().rules;
  for (const auto object : {objects::kControlword, objects::kStatusword, objects::kModeOfOperation,
                            objects::kModeDisplay, objects::kTargetVelocity})
    EXPECT_EQ(drive::access_alarm(without_objects, object), "") << to_string(object);
  EXPECT_EQ(drive::access_alarm(without_objects, {0x6064, 0}), "Er26-1");
}

TEST_F(Wary, IdentificationAsksOneDa200ForItsNumbersOnly) {
  for (const std::string named : {"da200", "gsd600", "dm", "ts"}) {
    auto session = open("da200");
    asked.clear();
    const auto rules = drive::load_profile(named, kFolders).value().rules;
    (void)identify(session, nodes, rules);
    EXPECT_FALSE(asked.empty());
    for (const auto object : asked)
      EXPECT_TRUE(object.index == 0x1000 || object.index == 0x1018) << named << ": " << to_string(object);
  }
}

TEST_F(Wary, ANamedFamilyIsCheckedBeforeTheFirstRequestThatCouldRaiseAnAlarm) {
  auto session = open("da200");
  session.options().checks_numbers = true;
  asked.clear();
  EXPECT_TRUE(session.upload(1, objects::kStatusword).has_value());
  EXPECT_TRUE(session.upload(1, objects::kPositionActual).has_value());
  EXPECT_EQ(asked, (std::vector<ObjectAddress>{objects::kStatusword, objects::kPositionActual}))
      << "every drive that raises alarms has these";
  asked.clear();
  EXPECT_EQ(session.upload(1, kNotOfDa200).error().abort_code, canopen::sdo_abort::kNoObject);
  EXPECT_EQ(asked,
            (std::vector<ObjectAddress>{objects::kDeviceType, objects::kVendorId, objects::kProductCode}));
}

/// Most families have none: their rules are only searched for the words.
TEST(AccessAlarms, TheRulesOfAFamilyThatHasThemAreFound) {
  for (const auto& family : drive::find_families(kFolders)) {
    const auto rules = drive::load_rules(family);
    ASSERT_TRUE(rules.has_value()) << family.name;
    EXPECT_EQ(drive::alarm_rules(family) != nullptr, drive::has_access_alarms(*rules)) << family.name;
  }
  const auto stem = std::filesystem::path(testing::TempDir()) / fmt::format("{}-alarming", ::getpid());
  const auto file = stem.string() + ".toml";
  std::ofstream(file) << "format = 1\nfamily = \"alarming\"\n[fault]\n\"object\\u005falarm\" = \"Er1\"\n";
  EXPECT_TRUE(drive::load_rules({"alarming", stem}).has_value())
      << drive::load_rules({"alarming", stem}).error().message.text();
  EXPECT_NE(drive::alarm_rules({"alarming", stem}), nullptr) << "a key may be written so";
  std::filesystem::remove(file);
}

TEST_F(Wary, SilenceOfTheNodeEndsWhatWasFound) {
  auto session = open("da200");
  consider_numbers(session, nodes);
  ASSERT_TRUE(session.is_considered(1));
  ASSERT_TRUE(session.can()->send(can::parse_frame("000#0201").value()).has_value());
  EXPECT_EQ(session.upload(1, objects::kStatusword).error().code, Errc::timeout);
  EXPECT_FALSE(session.is_considered(1)) << "another drive may come in its place";
}

TEST_F(Wary, WhatWasFoundEndsWithTheNextBootUp) {
  auto session = open("da200");
  consider_numbers(session, nodes);
  EXPECT_TRUE(session.is_considered(1));
  asked.clear();
  consider_numbers(session, nodes);
  EXPECT_TRUE(asked.empty()) << "once";
  ASSERT_TRUE(session.can()->send(can::parse_frame("000#8101").value()).has_value());
  for (int i = 0; i < 50 && session.is_considered(1); ++i)
    (void)session.step(session.now() + std::chrono::milliseconds(100));
  EXPECT_FALSE(session.is_considered(1));
}

}  // namespace
}  // namespace servoctl::session
