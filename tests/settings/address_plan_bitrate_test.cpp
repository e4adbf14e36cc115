// A plan whose drives get another bitrate: only the drives that it was made for, all that is sent shown
// before, and the interface taken along when all have it.
#include <gtest/gtest.h>

#include <iterator>

#include "tests/settings/address_plan_world.hpp"
#include "tests/settings/bitrate_cell.hpp"

namespace servoctl::settings {
namespace {

class PlanOfBitrates : public PlanOfAddresses {
 protected:
  static void name(AddressWorld& world, std::uint32_t first_serial) {
    for (const auto& drive : world.drives) drive->model().set_serial(first_serial++);
    const auto settle = [&] {
      (void)world.session->wait([] { return false; }, world.session->now() + std::chrono::seconds(2));
    };
    settle();
    (void)world.bus.send(*can::parse_frame("000#8100"));
    settle();
    world.restart_session();
  }
  /// The second drive falls silent when the first one has its bitrate.
  void interrupt(AddressWorld& world) {
    const auto bitrate = *drive::place_of(world.profile, "Pn0048");
    world.hooks.before_send = [&world, bitrate](const can::Frame& frame) {
      if (is_write_to(frame, bitrate)) world.drives[1]->wire_faults().silent = true;
    };
    const auto done = run(world);
    ASSERT_TRUE(done) << done.error().message.text();
    EXPECT_FALSE(world.desk.errors.empty());
    EXPECT_EQ(world.held(0, "Pn0048"), 5U);
    EXPECT_TRUE(has_journal());
  }
  /// With the interface of the cell, which may be changed.
  Result<report::Value> run_in(BitrateCell& cell, const std::vector<const drive::Profile*>& profiles) {
    AddressPlanOptions options;
    options.family_of = [profiles](const AddressRow& row) -> Result<const drive::Profile*> {
      return profiles[row.line - 2];
    };
    options.follower = [this, &cell](std::span<const AddressChange> changes,
                                     std::uint32_t bitrate) -> Result<BitrateSwitch> {
      if (++looks_ == 2 && behind_the_moves_)
        if (const auto so = behind_the_moves_(); !so) return fail(so.error());
      auto link = std::make_unique<session::FakeLink>(cell.link->now);
      cell.link = link.get();
      return plan_switch(cell.world.desk, std::move(link), changes, bitrate, {}, true);
    };
    auto done = run_address_plan(cell.world.desk, text_, file_, options);
    cell.link = cell.owned.get();
    return done;
  }

  int looks_ = 0;
  std::function<Result<void>()> behind_the_moves_;  ///< Of those who are on the bus, asked a second time.
};

TEST_F(PlanOfBitrates, WritesNoneToADriveThatWasReplacedBeforeItIsResumed) {
  for (const std::string_view text :
       {"node,new,serial,bitrate\n1,1,1,250k\n2,2,2,250k\n", "node,new,bitrate\n1,1,250k\n2,2,250k\n"}) {
    text_ = text;
    std::filesystem::remove(address_journal_of(file_));
    AddressWorld world("gsd600", {1, 2});
    name(world, 1);
    interrupt(world);
    AddressWorld replaced("gsd600", {1, 2});
    name(replaced, 11);
    const auto before = replaced.held(0, "Pn0048");
    ASSERT_NE(before, 5U);
    (void)run(replaced, true);
    ASSERT_FALSE(replaced.desk.errors.empty()) << text;
    EXPECT_EQ(replaced.desk.errors.front().code, Errc::refused)
        << replaced.desk.errors.front().message.text();
    EXPECT_EQ(replaced.held(0, "Pn0048"), before);
    EXPECT_EQ(replaced.held(1, "Pn0048"), before);
    EXPECT_TRUE(has_journal()) << "it can still be resumed with the drives that it was made for";
  }
}

TEST_F(PlanOfBitrates, IsResumedWithTheDrivesThatItWasMadeFor) {
  text_ = "node,new,serial,bitrate\n1,1,1,250k\n2,2,2,250k\n";
  AddressWorld world("gsd600", {1, 2});
  name(world, 1);
  interrupt(world);
  world.drives[1]->wire_faults().silent = false;
  world.hooks = {};
  world.restart_session();
  const auto done = run(world, true);
  ASSERT_TRUE(done) << done.error().message.text();
  EXPECT_TRUE(world.desk.errors.empty()) << world.desk.errors.front().message.text();
  EXPECT_EQ(world.held(1, "Pn0048"), 5U);
  EXPECT_FALSE(has_journal());
}

/// Writes and NMT, in their order.
TEST_F(PlanOfBitrates, ADryRunShowsTheFramesThatAreSent) {
  for (const auto* const text : {"node,new,bitrate\n1,1,250k\n", "node,new\n1,2\n2,1\n3,13\n",
                                 "node,new,bitrate\n1,2,250k\n2,1,\n3,3,250k\n"}) {
    text_ = text;
    AddressWorld world("gsd600", {1, 2, 3});
    world.desk.dry_run = true;
    const auto planned = run(world);
    ASSERT_TRUE(planned) << planned.error().message.text();
    const auto changes = [](const std::string& text_of_frame) {
      const auto frame = *can::parse_frame(text_of_frame);
      return frame.id == 0 || (frame.id > 0x600 && frame.id < 0x680 && (frame.data[0] & 0xE0U) == 0x20);
    };
    EXPECT_EQ(std::count_if(world.sent.begin(), world.sent.end(), changes), 0) << "a dry run sends none";
    std::vector<std::string> shown;
    for (const auto& row : planned->table()->rows) shown.push_back(std::get<std::string>(row.back().data()));
    world.restart_session();
    world.sent.clear();
    ASSERT_TRUE(run(world));
    std::vector<std::string> sent;
    std::copy_if(world.sent.begin(), world.sent.end(), std::back_inserter(sent), changes);
    EXPECT_EQ(shown, sent) << text;
  }
}

TEST_F(PlanOfBitrates, TakesTheInterfaceAlongWithDrivesOfSeveralFamilies) {
  const auto other = drive::load_profile("da200", kFolders).value();
  BitrateCell cell("gsd600", {3});
  cell.world.add(4, other);
  cell.wire->rates[4] = 250'000;
  text_ = "node,new,bitrate\n3,3,125k\n4,4,125k\n";
  const auto done = run_in(cell, {&cell.world.profile, &other});
  ASSERT_TRUE(done) << done.error().message.text();
  EXPECT_TRUE(cell.world.desk.errors.empty()) << cell.world.desk.errors.front().message.text();
  for (const auto& row : done->table()->rows)
    EXPECT_EQ(std::get<std::string>(row.back().data()), "found at its new bitrate");
  EXPECT_EQ(cell.world.count("000#8100"), 1U);
  EXPECT_EQ(cell.world.notices(), "");
  EXPECT_FALSE(has_journal());
}

TEST_F(PlanOfBitrates, RestartsNobodyWhereSomebodyWasEnabledMeanwhile) {
  BitrateCell cell("gsd600", {3});
  text_ = "node,new,bitrate\n3,3,125k\n";
  behind_the_moves_ = [] { return fail(Errc::refused, "node 3 is energised"); };
  ASSERT_TRUE(run_in(cell, {&cell.world.profile}));
  EXPECT_EQ(looks_, 2);
  ASSERT_FALSE(cell.world.desk.errors.empty());
  EXPECT_EQ(cell.world.desk.errors.front().message.text(), "node 3 is energised");
  EXPECT_EQ(cell.world.count("000#8100"), 0U);
  EXPECT_TRUE(has_journal()) << "--resume goes on with the switch alone";
  EXPECT_NE(cell.world.notices().find("--resume continues"), std::string::npos) << cell.world.notices();
}

TEST_F(PlanOfBitrates, LeavesTheInterfaceWhereSomebodyHasNoRow) {
  BitrateCell cell("gsd600");
  text_ = "node,new,bitrate\n3,3,125k\n";
  ASSERT_TRUE(run_in(cell, {&cell.world.profile}));
  EXPECT_EQ(cell.world.count("000#8100"), 0U);
  EXPECT_NE(cell.world.notices().find("node 4 would be left at 250 kbit/s"), std::string::npos)
      << cell.world.notices();
}

TEST_F(PlanOfBitrates, TellsWhatToDoByHandOnlyWhenAllHaveIt) {
  text_ = "node,new,bitrate\n1,1,250k\n2,2,250k\n";
  for (const bool fails : {false, true}) {
    std::filesystem::remove(address_journal_of(file_));
    AddressWorld world("gsd600", {1, 2});
    const auto bitrate = *drive::place_of(world.profile, "Pn0048");
    if (fails) world.drives[1]->misbehaviour().refused.insert(bitrate.index);
    ASSERT_TRUE(run(world));
    EXPECT_EQ(world.desk.errors.empty(), !fails);
    EXPECT_EQ(world.notices().find("switch all of them off") == std::string::npos, fails) << world.notices();
  }
}

TEST_F(PlanOfBitrates, NamesTheFamilyInTheLineThatItTells) {
  EXPECT_EQ(bitrate_steps("can0", 250'000, "gsd600").front(),
            "`address --bitrate 250000 -n all -d gsd600` restarts all drives and switches can0 with them; by "
            "hand:");
  EXPECT_EQ(bitrate_steps("can0", 250'000, "").front(),
            "change all nodes of the bus before any of them restarts: one with another bitrate disturbs the "
            "rest");
}

}  // namespace
}  // namespace servoctl::settings
