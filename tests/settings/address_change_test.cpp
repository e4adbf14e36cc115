// A drive gets another node-ID by its family's parameter: written, kept, restarted and found again, or as
// before.
#include "settings/address_change.hpp"

#include <gtest/gtest.h>

#include "tests/settings/address_world.hpp"

namespace servoctl::settings {
namespace {

using namespace std::chrono_literals;

class AddressOf : public testing::TestWithParam<const char*> {};

TEST_P(AddressOf, ADriveThatIsRestartedOverTheBusIsFoundAtItsNewNode) {
  AddressWorld world(GetParam(), {3});
  const auto outcome = move_to(world, 3, 5);
  EXPECT_EQ(outcome.end, AddressEnd::moved) << (outcome.error ? outcome.error->message.text() : "");
  EXPECT_EQ(world.drives[0]->node(), 5);
  EXPECT_EQ(world.count("000#8103"), 1U);
  // A power cycle changes nothing any more.
  world.drives[0]->model().power_on(world.bus.now());
  EXPECT_EQ(world.drives[0]->node(), 5);
}

INSTANTIATE_TEST_SUITE_P(Families, AddressOf, testing::Values("gsd600", "da200", "dm"),
                         [](const auto& family) { return std::string(family.param); });

TEST(AddressChange, ADriveThatNeedsThePowerSwitchedIsToldSoAndNotRestarted) {
  AddressWorld world("ts", {3});
  const auto outcome = move_to(world, 3, 5, {.unlock = true});
  EXPECT_EQ(outcome.end, AddressEnd::awaits_restart);
  EXPECT_FALSE(outcome.error);
  EXPECT_EQ(outcome.kept, session::Kept::yes);
  EXPECT_EQ(world.held(0, "Fn_9A"), 5U);
  EXPECT_EQ(world.held(0, "Fn_3F"), 9870U) << "the password is taken back";
  for (const auto& frame : world.sent) EXPECT_FALSE(frame.starts_with("000#")) << frame;
}

TEST(AddressChange, ADriveThatIsSwitchedOffAndOnIsWaitedFor) {
  AddressWorld world("ts", {3});
  const auto at = world.bus.now() + 20s;
  bool switched = false;
  world.hooks.on_time = [&](TimePoint now) {
    if (switched || now < at) return;
    switched = true;
    world.switch_off_and_on(0);
  };
  const auto outcome = move_to(world, 3, 5, {.unlock = true, .patience = 60s});
  EXPECT_EQ(outcome.end, AddressEnd::moved) << (outcome.error ? outcome.error->message.text() : "");
}

TEST(AddressChange, ADriveThatNobodySwitchesOffIsToldToBeAtItsOldNode) {
  AddressWorld world("ts", {3});
  const auto outcome = move_to(world, 3, 5, {.unlock = true, .patience = 10s});
  EXPECT_EQ(outcome.end, AddressEnd::awaits_restart);
  ASSERT_TRUE(outcome.error);
  EXPECT_EQ(outcome.error->code, Errc::negative);
  EXPECT_NE(outcome.error->message.text().find("not switched off"), std::string::npos)
      << outcome.error->message.text();
}

TEST(AddressChange, ALockedParameterNamesThePassword) {
  AddressWorld world("ts", {3});
  const auto outcome = move_to(world, 3, 5);
  EXPECT_EQ(outcome.end, AddressEnd::as_before);
  ASSERT_TRUE(outcome.error);
  EXPECT_NE(outcome.error->hint.text().find("--unlock"), std::string::npos) << outcome.error->hint.text();
  EXPECT_EQ(world.held(0, "Fn_9A"), 3U);
}

TEST(AddressChange, AfterCtrlCNothingIsWritten) {
  AddressWorld world("gsd600", {3});
  const auto change = plan_address(world.desk, 3, {.node = 5});
  ASSERT_TRUE(change) << change.error().message.text();
  world.session->options().cancelled = [] { return true; };
  world.sent.clear();
  const auto outcome = change_address(world.desk, *change, {});
  EXPECT_EQ(outcome.end, AddressEnd::as_before);
  ASSERT_TRUE(outcome.error);
  EXPECT_EQ(outcome.error->code, Errc::interrupted);
  EXPECT_TRUE(world.sent.empty()) << world.sent.front();
}

TEST(AddressChange, TheNodeThatItHasAlreadyIsNothingToDo) {
  AddressWorld world("gsd600", {3});
  const auto outcome = move_to(world, 3, 3);
  EXPECT_EQ(outcome.end, AddressEnd::nothing_to_do);
  for (const auto& frame : world.sent) EXPECT_FALSE(frame.starts_with("000#")) << frame;
}

TEST(AddressChange, AnAddressThatWaitsForARestartIsTakenBackByTheNodeThatItHas) {
  AddressWorld world("gsd600", {3});
  ASSERT_TRUE(world.session->download(3, *drive::place_of(world.profile, "Pn0049"), store_le(7, 2)));
  const auto change = plan_address(world.desk, 3, {.node = 3});
  ASSERT_TRUE(change);
  EXPECT_EQ(change->writes.size(), 1U);
  EXPECT_EQ(change_address(world.desk, *change, {}).end, AddressEnd::moved);
  EXPECT_EQ(world.held(0, "Pn0049"), 3U);
}

TEST(AddressChange, ALostAnswerToTheWriteIsLookedUp) {
  AddressWorld world("gsd600", {3});
  const auto place = *drive::place_of(world.profile, "Pn0049");
  world.hooks.before_send = [&](const can::Frame& frame) {
    if (is_write_to(frame, place)) world.drives[0]->wire_faults().drop_answers = 1;
  };
  EXPECT_EQ(move_to(world, 3, 5).end, AddressEnd::moved);
  EXPECT_EQ(world.count("602#2B00203205000000"), 0U);
  EXPECT_EQ(world.count("603#2B00203205000000"), 1U) << "a write is never sent twice";
}

TEST(AddressChange, AWriteThatIsRefusedChangesNothing) {
  AddressWorld world("gsd600", {3});
  world.drives[0]->misbehaviour().refused.insert(0x2000);
  const auto outcome = move_to(world, 3, 5);
  EXPECT_EQ(outcome.end, AddressEnd::as_before);
  EXPECT_EQ(world.drives[0]->node(), 3);
  EXPECT_EQ(world.count("000#8103"), 0U);
}

TEST(AddressChange, AWriteThatIsAcknowledgedAndNotDoneIsNoticed) {
  AddressWorld world("gsd600", {3});
  world.drives[0]->misbehaviour().feigned.insert(0x2000);
  const auto outcome = move_to(world, 3, 5);
  ASSERT_TRUE(outcome.error);
  EXPECT_NE(outcome.error->message.text().find("acknowledged"), std::string::npos)
      << outcome.error->message.text();
  EXPECT_EQ(world.count("000#8103"), 0U) << "what is not written is not restarted";
}

TEST(AddressChange, AnAddressThatCannotBeKeptIsPutBack) {
  AddressWorld world("dm", {3});
  world.drives[0]->misbehaviour().refused.insert(0x1010);
  const auto outcome = move_to(world, 3, 5);
  EXPECT_EQ(outcome.end, AddressEnd::as_before);
  ASSERT_TRUE(outcome.error);
  EXPECT_NE(outcome.error->message.text().find("written back"), std::string::npos)
      << outcome.error->message.text();
  EXPECT_EQ(world.held(0, "0x2003:01"), 3U);
  EXPECT_EQ(world.count("000#8103"), 0U);
}

TEST(AddressChange, AnAddressWhoseStoringIsNotAnsweredMayHold) {
  AddressWorld world("gsd600", {3});
  world.hooks.before_send = [&](const can::Frame& frame) {
    if (is_write_to(frame, objects::kStoreAll)) world.drives[0]->wire_faults().drop_answers = 1;
  };
  const auto outcome = move_to(world, 3, 5);
  EXPECT_EQ(outcome.end, AddressEnd::failed) << text_of(outcome.end);
  ASSERT_TRUE(outcome.error);
  EXPECT_NE(outcome.error->message.text().find("which of them it has after power-off is not known"),
            std::string::npos)
      << outcome.error->message.text();
  EXPECT_EQ(world.held(0, "Pn0049"), 3U) << "the old one was written back";
}

TEST(AddressChange, AnEnergisedDriveIsLeftAlone) {
  AddressWorld world("gsd600", {3});
  for (const auto word : {0x06U, 0x07U, 0x0FU})
    ASSERT_TRUE(world.session->download(3, objects::kControlword, store_le(word, 2)));
  const auto change = plan_address(world.desk, 3, {.node = 5});
  ASSERT_FALSE(change);
  EXPECT_EQ(change.error().code, Errc::refused);
}

TEST(AddressChange, AnotherSerialNumberThanTheOneMeantIsRefused) {
  AddressWorld world("gsd600", {3});
  const auto change = plan_address(world.desk, 3, {.node = 5, .serial = 4711});
  ASSERT_FALSE(change);
  EXPECT_EQ(change.error().code, Errc::refused);
}

TEST(AddressChange, AFamilyWithoutTheParameterIsRefused) {
  AddressWorld world("cia402", {3});
  const auto change = plan_address(world.desk, 3, {.node = 5});
  ASSERT_FALSE(change);
  EXPECT_EQ(change.error().code, Errc::usage);
}

TEST(AddressChange, ANodeIdOutOfRangeIsRefused) {
  AddressWorld world("gsd600", {3});
  for (const unsigned node : {0U, 128U, 255U})
    EXPECT_FALSE(plan_address(world.desk, 3, {.node = static_cast<std::uint8_t>(node)}));
}

TEST(AddressChange, ADriveWithANewBitrateIsNotRestarted) {
  AddressWorld world("gsd600", {3});
  const auto change = plan_address(world.desk, 3, {.bitrate = 500'000});
  ASSERT_TRUE(change);
  const auto outcome = change_address(world.desk, *change, {});
  EXPECT_EQ(outcome.end, AddressEnd::awaits_restart);
  EXPECT_EQ(world.held(0, "Pn0048"), 6U);
  for (const auto& frame : world.sent) EXPECT_FALSE(frame.starts_with("000#")) << frame;
  EXPECT_NE(bitrate_steps("can0", 500'000, "gsd600")[3].find("`bus up can0 --bitrate 500000`"),
            std::string::npos);
}

TEST(AddressChange, ADriveWithANewBitrateIsNotWaitedForEither) {
  AddressWorld world("gsd600", {3});
  const auto change = plan_address(world.desk, 3, {.bitrate = 500'000});
  ASSERT_TRUE(change);
  const auto outcome = change_address(world.desk, *change, {.patience = 60s});
  EXPECT_EQ(outcome.end, AddressEnd::awaits_restart);
  EXPECT_FALSE(outcome.error) << outcome.error->message.text();
}

TEST(AddressChange, BothValuesAreWrittenOrNone) {
  AddressWorld world("gsd600", {3});
  const auto change = plan_address(world.desk, 3, {.node = 5, .bitrate = 500'000});
  ASSERT_TRUE(change);
  ASSERT_EQ(change->writes.size(), 2U);
  const auto second = change->writes[1].object;
  world.hooks.before_send = [&](const can::Frame& frame) {
    if (is_write_to(frame, second)) world.drives[0]->misbehaviour().refused.insert(0x2000);
    if (frame.id == 0x603 && (frame.data[0] & 0xE0U) == 0x40) world.drives[0]->misbehaviour().refused.clear();
  };
  // The second is refused, and the drive takes writes again when it is looked at.
  const auto outcome = change_address(world.desk, *change, {});
  EXPECT_TRUE(outcome.error);
  EXPECT_EQ(world.held(0, "Pn0048"), 8U);
  EXPECT_EQ(world.held(0, "Pn0049"), 3U) << "the first was written, and is put back";
  EXPECT_EQ(world.count("000#8103"), 0U);
}

/// Put back with the switch at the flash: a trial would be kept in place of what the flash held.
TEST(AddressChange, WhatWasPutBackIntoTheFlashOfADriveThatWorkedInItsRamIsTold) {
  for (const bool trial : {false, true}) {
    AddressWorld world("ts", {3});
    const auto set = [&](const char* name, std::uint64_t value) {
      const auto place = *drive::place_of(world.profile, name);
      const auto size = world.session->upload(3, place)->size();
      ASSERT_TRUE(world.session->download(3, place, store_le(value, size))) << name;
    };
    set("Fn_3F", 9876);
    set("Fn_99", 1);
    if (trial) set("Fn_9A", 7);
    const auto change = plan_address(world.desk, 3, {.node = 5, .bitrate = 250'000});
    ASSERT_TRUE(change) << change.error().message.text();
    world.drives[0]->misbehaviour().refused.insert(drive::place_of(world.profile, "Fn_9C")->index);
    const auto outcome = change_address(world.desk, *change, {.unlock = true});
    ASSERT_TRUE(outcome.error);
    EXPECT_EQ(outcome.end, trial ? AddressEnd::failed : AddressEnd::as_before)
        << outcome.error->message.text();
    EXPECT_EQ(outcome.error->message.text().find("its flash was not put back") != std::string::npos, trial)
        << outcome.error->message.text();
  }
}

TEST(AddressChange, COBIDsThatAreStoredWithTheOldNodeAreNamed) {
  AddressWorld world("dm", {3});
  ASSERT_TRUE(world.session->download(3, objects::kStoreAll, store_le(objects::kSaveSignature, 4)));
  const auto outcome = move_to(world, 3, 5);
  EXPECT_EQ(outcome.end, AddressEnd::moved);
  EXPECT_FALSE(outcome.stayed.empty());
  EXPECT_NE(world.notices().find("0x1400:1 = 0x00000203"), std::string::npos) << world.notices();
  EXPECT_NE(world.notices().find("`pdo show -n 5 -d dm`"), std::string::npos) << "where it is now";
}

TEST(AddressChange, COBIDsThatFollowAreNotNamed) {
  AddressWorld world("da200", {3});
  EXPECT_TRUE(move_to(world, 3, 5).stayed.empty());
  EXPECT_EQ(world.notices().find("COB-ID"), std::string::npos) << world.notices();
}

TEST(AddressChange, NobodyElseIsWrittenTo) {
  AddressWorld world("gsd600", {3, 4, 6});
  EXPECT_EQ(move_to(world, 3, 5).end, AddressEnd::moved);
  EXPECT_EQ(world.drives[1]->node(), 4);
  EXPECT_EQ(world.drives[2]->node(), 6);
  for (const auto& text : world.sent) {
    const auto frame = *can::parse_frame(text);
    const bool of_it = frame.id == 0x603 || frame.id == 0x605 || text == "000#8103";
    EXPECT_TRUE(of_it) << text;
  }
}

}  // namespace
}  // namespace servoctl::settings
