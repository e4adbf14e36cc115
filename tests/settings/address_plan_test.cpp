// A plan of addresses: in an order without collisions, and gone on with from wherever it was cut off.
#include "tests/settings/address_plan_world.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <filesystem>

#include "base/file.hpp"
#include "settings/address_journal.hpp"
#include "tests/session/troubled_bus.hpp"
#include "tests/settings/address_world.hpp"

namespace servoctl::settings {
namespace {

using Taken = std::set<std::uint8_t>;

std::string order_of(const char* csv, const Taken& taken) {
  const auto rows = parse_address_plan(csv, "plan.csv");
  if (!rows) return rows.error().message.text();
  const auto steps = order_address_steps(*rows, taken);
  if (!steps) return steps.error().message.text();
  std::string out;
  for (const auto& step : *steps) out += fmt::format("{}{}>{}", out.empty() ? "" : " ", step.from, step.to);
  return out;
}

TEST(AddressPlan, MovesADriveWhenItsPlaceWasLeft) {
  EXPECT_EQ(order_of("node,new\n1,2\n2,3\n3,4\n", {1, 2, 3}), "3>4 2>3 1>2");
  EXPECT_EQ(order_of("node,new\n1,11\n2,12\n", {1, 2}), "1>11 2>12");
  EXPECT_EQ(order_of("node,new\n1,1\n2,3\n", {1, 2}), "2>3");
}

TEST(AddressPlan, LeadsACircleThroughAFreeNode) {
  EXPECT_EQ(order_of("node,new\n1,2\n2,1\n", {1, 2}), "1>127 2>1 127>2");
  EXPECT_EQ(order_of("node,new\n1,2\n2,3\n3,1\n", {1, 2, 3, 127}), "1>126 3>1 2>3 126>2");
  EXPECT_EQ(order_of("node,new\n1,2\n2,1\n3,4\n4,3\n", {1, 2, 3, 4}), "1>127 2>1 127>2 3>127 4>3 127>4");
}

TEST(AddressPlan, RefusesANodeThatAnotherOneHas) {
  EXPECT_NE(order_of("node,new\n1,5\n", {1, 5}).find("taken"), std::string::npos);
}

TEST(AddressPlan, RefusesACircleWhereNoNodeIsFree) {
  Taken all;
  for (std::uint8_t node = 1; node <= 127; ++node) all.insert(node);
  EXPECT_NE(order_of("node,new\n1,2\n2,1\n", all).find("no node-ID is free"), std::string::npos);
}

TEST(AddressPlan, NamesTheLineOfWhatIsWrong) {
  const std::pair<const char*, const char*> rows[] = {
      {"node,new\n0,5\n", "plan.csv:2"},
      {"node,new\n1,128\n", "plan.csv:2"},
      {"node,new\n1,5\n1,6\n", "plan.csv:3"},
      {"node,new\n1,5\n2,5\n", "plan.csv:3"},
      {"node,to\n1,5\n", "unknown column"},
      {"node\n1\n", "node and new"},
      {"node,new\n", "no drive"},
      {"node,new,bitrate\n1,2,fast\n", "plan.csv:2"},
      {"node,new,bitrate\n1,5,500k\n2,2,250k\n", "plan.csv:3"},
      {"node,new,serial\n1,2,abc\n", "plan.csv:2"},
      {"", ""},
      {"node,new\n1,\n", "plan.csv:2"}};
  for (const auto& [csv, part] : rows) {
    const auto read = parse_address_plan(csv, "plan.csv");
    ASSERT_FALSE(read) << csv;
    EXPECT_NE(read.error().message.text().find(part), std::string::npos)
        << csv << ": " << read.error().message.text();
  }
}

TEST_F(PlanOfAddresses, PutsEveryDriveWhereItIsToBe) {
  AddressWorld world("gsd600", {1, 2, 3, 4});
  ASSERT_TRUE(run(world));
  EXPECT_TRUE(world.desk.errors.empty()) << world.desk.errors.front().message.text();
  EXPECT_EQ(nodes(world), "2 3 1 14");
  EXPECT_FALSE(has_journal());
}

TEST_F(PlanOfAddresses, AskedASecondTimeFindsTheirPlacesTaken) {
  AddressWorld world("gsd600", {1, 2, 3, 4});
  ASSERT_TRUE(run(world));
  const auto again = run(world);
  EXPECT_FALSE(again) << "node 4 is gone, and the others would go round once more";
  EXPECT_EQ(nodes(world), "2 3 1 14");
}

TEST_F(PlanOfAddresses, KilledAnywhereCanBeGoneOnWith) {
  text_ = "node,new\n1,2\n2,1\n";
  // Every third frame behind the question who is there.
  int frames = 265;
  int resumed = 0;
  for (int kill_at = 262; kill_at < frames; kill_at += 3) {
    fs::remove(address_journal_of(file_));
    AddressWorld world("gsd600", {1, 2});
    session::Trouble trouble;
    trouble.kill_at = kill_at;
    auto bus = std::make_unique<session::TroubledBus>(world.bus, *world.drives[0], trouble, 1);
    const auto* counted = bus.get();
    world.restart_session(std::move(bus));
    try {
      (void)run(world);
      frames = counted->frames();
    } catch (const session::Killed&) {
      frames = std::max(frames, kill_at + 4);
    }
    const bool journal = has_journal();
    world.restart_session();
    const auto done = run(world, journal);
    resumed += journal ? 1 : 0;
    if (!journal && nodes(world) != "2 1") continue;
    ASSERT_TRUE(done) << kill_at << ": " << done.error().message.text();
    EXPECT_TRUE(world.desk.errors.empty()) << kill_at << ": " << world.desk.errors.front().message.text();
    EXPECT_EQ(nodes(world), "2 1") << kill_at;
    EXPECT_FALSE(has_journal()) << kill_at;
  }
  EXPECT_GT(resumed, 20);
}

TEST_F(PlanOfAddresses, LostWithTheBusIsGoneOnWith) {
  AddressWorld world("gsd600", {1, 2, 3, 4});
  int resets = 0;
  world.hooks.before_send = [&](const can::Frame& frame) {
    resets += frame.id == 0 ? 1 : 0;
    world.hooks.lost = resets >= 2;
  };
  (void)run(world);
  ASSERT_FALSE(world.desk.errors.empty());
  EXPECT_EQ(world.desk.errors.front().code, Errc::bus);
  EXPECT_TRUE(has_journal());
  world.hooks = {};
  world.restart_session();
  EXPECT_FALSE(run(world)) << "a plan that was interrupted is gone on with, never begun anew";
  ASSERT_TRUE(run(world, true));
  EXPECT_EQ(nodes(world), "2 3 1 14");
}

TEST_F(PlanOfAddresses, EndsWithTheFirstDriveThatFails) {
  AddressWorld world("gsd600", {1, 2, 3, 4});
  world.drives[3]->misbehaviour().refused.insert(0x2000);
  text_ = "node,new\n4,14\n1,11\n";
  ASSERT_TRUE(run(world));
  ASSERT_FALSE(world.desk.errors.empty());
  EXPECT_NE(world.desk.errors.front().message.text().find("line 2"), std::string::npos);
  EXPECT_EQ(nodes(world), "1 2 3 4");
  EXPECT_FALSE(has_journal()) << "nothing was changed";
}

TEST_F(PlanOfAddresses, WritesNothingWhereADriveDoesNotAnswer) {
  AddressWorld world("gsd600", {1, 2});
  text_ = "node,new\n1,11\n9,12\n";
  const auto done = run(world);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().node, 9);
  EXPECT_EQ(nodes(world), "1 2");
}

TEST_F(PlanOfAddresses, AChangedFileOrJournalIsRefused) {
  AddressWorld world("gsd600", {1, 2, 3, 4});
  AddressJournal journal;
  journal.checksum = "fnv1a64:0";
  journal.drives.resize(4);
  for (auto& drive : journal.drives) drive.node = 1;
  journal.steps = {{0, 1, 11}};
  ASSERT_TRUE(write_address_journal(address_journal_of(file_), journal));
  const auto changed = run(world, true);
  ASSERT_FALSE(changed);
  EXPECT_EQ(changed.error().code, Errc::refused);
  auto text = *read_file(address_journal_of(file_));
  text.replace(text.find("\"to\":11"), 7, "\"to\":12");
  ASSERT_TRUE(write_file_atomically(address_journal_of(file_), text));
  const auto broken = run(world, true);
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().code, Errc::file);
}

TEST_F(PlanOfAddresses, NobodySaysYesAndNothingIsSent) {
  AddressWorld world("gsd600", {1, 2, 3, 4});
  show::Unwilling unwilling;
  world.desk.audience = &unwilling;
  const auto done = run(world);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::refused);
  EXPECT_EQ(nodes(world), "1 2 3 4");
  EXPECT_FALSE(has_journal());
}

TEST_F(PlanOfAddresses, WritesBitratesAtTheEndAndRestartsNobodyThen) {
  AddressWorld world("gsd600", {1, 2});
  text_ = "node,new,bitrate\n1,2,500k\n2,1,500k\n";
  ASSERT_TRUE(run(world));
  EXPECT_TRUE(world.desk.errors.empty()) << world.desk.errors.front().message.text();
  EXPECT_EQ(nodes(world), "2 1");
  EXPECT_EQ(world.held(0, "Pn0048"), 6U);
  EXPECT_EQ(world.held(1, "Pn0048"), 6U);
  const auto reset = std::find_if(world.sent.rbegin(), world.sent.rend(),
                                  [](const std::string& frame) { return frame.starts_with("000#"); });
  const auto write = std::find_if(world.sent.begin(), world.sent.end(), [](const std::string& frame) {
    return frame.find("#2B002031") != std::string::npos;
  });
  EXPECT_TRUE(reset.base() <= write);
}

}  // namespace
}  // namespace servoctl::settings
