// LSS slaves and the interface of their bus go to another bitrate together: between the two silences, with
// nobody left behind, and where it fails the error says where everybody is.
#include "settings/lss_bitrate.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "tests/session/fake_link.hpp"
#include "tests/session/lss_world.hpp"
#include "tests/show/audiences.hpp"

namespace servoctl::settings {
namespace {

using namespace std::chrono_literals;

/// A drive on a wire with bits: it hears and is heard only at the bitrate of the interface, and changes its
/// own when LSS activates what it has confirmed.
class TunedDrive final : public sim::Device {
 public:
  TunedDrive(sim::SimDrive& drive, session::FakeLink*& link) : drive_(&drive), link_(&link) {}

  void on_frame(const can::Frame& frame, TimePoint now) override {
    follow(now);
    if (!hears()) return;
    if (silent_from_ <= now && now < silent_until_) disturbed = true;
    if (frame.id == canopen::kLssRequest && frame.data[0] == 0x15 && pending_ && !ignores) {
      activated = true;
      const auto delay = std::chrono::milliseconds(frame.data[1] | frame.data[2] << 8);
      silent_from_ = switches_at_ = now + delay;
      silent_until_ = now + 2 * delay;
    }
    drive_->on_frame(frame, now);
  }
  void on_time(TimePoint now) override {
    follow(now);
    drive_->on_time(now);
  }
  std::optional<can::Frame> take_frame() override {
    const auto frame = drive_->take_frame();
    if (frame && frame->id == canopen::kLssAnswer && frame->data[0] == 0x13 && frame->data[1] == 0)
      pending_ = 250'000;
    return frame && hears() ? frame : std::nullopt;
  }
  TimePoint deadline() const override { return std::min(drive_->deadline(), switches_at_); }

  std::uint32_t rate = 500'000;
  bool ignores = false;  ///< The activation.
  bool activated = false;
  bool disturbed = false;  ///< Somebody talked in the second silence.

 private:
  bool hears() const { return (*link_)->now.up && (*link_)->now.bitrate == rate; }
  void follow(TimePoint now) {
    if (now < switches_at_) return;
    rate = std::exchange(pending_, std::nullopt).value_or(rate);
    switches_at_ = kNever;
  }

  sim::SimDrive* drive_;
  session::FakeLink** link_;
  std::optional<std::uint32_t> pending_;
  TimePoint switches_at_ = kNever;
  TimePoint silent_from_{};
  TimePoint silent_until_{};
};

class LssBitrate : public session::LssWorld {
 protected:
  void build(std::string_view spec) {
    hooks.comes_back = true;
    cell = sim::build_cell(spec, kFolders, bus.now()).value();
    for (const auto& drive : cell.drives) {
      drives.push_back(std::make_unique<TunedDrive>(*drive, link));
      bus.attach(*drives.back());
    }
    session = std::make_unique<session::Session>(std::make_unique<session::LssBus>(bus, hooks), "can0",
                                                 session::Options{});
    (void)session->wait([] { return false; }, session->now() + 1s);
    desk.session = session.get();
    desk.audience = &willing;
  }
  static LssBitrateChange everybody(std::uint16_t delay_ms = 2000) {
    return {.all = true, .address = {}, .index = 3, .bitrate = 250'000, .delay_ms = delay_ms};
  }
  BitrateSwitch plan(const LssBitrateChange& change, bool may = true) {
    auto out = plan_lss_switch(std::move(owned), change, may);
    EXPECT_TRUE(out) << out.error().message.text();
    if (out) {
      EXPECT_TRUE(leave_nobody_behind(*session, change, *out));
    }
    return out ? std::move(*out) : BitrateSwitch{};
  }
  LssBitrateOutcome run(const LssBitrateChange& change) {
    follower = plan(change);
    EXPECT_TRUE(follower.follows()) << follower.why_not;
    const auto out = set_lss_bitrate(desk, change, follower);
    EXPECT_TRUE(out) << out.error().message.text();
    return out ? *out : LssBitrateOutcome{};
  }
  std::uint32_t bitrate() const { return link->now.bitrate.value_or(0); }

  std::unique_ptr<session::FakeLink> owned =
      std::make_unique<session::FakeLink>(session::controller(true, 500'000));
  session::FakeLink* link = owned.get();
  BitrateSwitch follower;
  std::vector<std::unique_ptr<TunedDrive>> drives;
  show::Willing willing;
  show::Desk desk;
};

TEST_F(LssBitrate, TheInterfaceGoesWithAllSlavesBetweenTheTwoSilences) {
  build("gsd600@3,sv2@4,sv2@255?lss");
  const auto begin = session->now();
  const auto out = run(everybody());
  EXPECT_FALSE(out.error) << out.error->message.text();
  EXPECT_EQ(out.slaves, 3U);
  EXPECT_EQ(bitrate(), 250'000U);
  EXPECT_EQ(link->done, (std::vector<std::string>{" down", " up type can bitrate 250000"}));
  EXPECT_GE(session->now() - begin, 4s);
  for (const auto& drive : drives) {
    EXPECT_EQ(drive->rate, 250'000U);
    EXPECT_FALSE(drive->disturbed) << "nobody talks until the second silence is over";
  }
  EXPECT_TRUE(all_wait());
}

TEST_F(LssBitrate, TheInterfaceGoesWithTheOnlyNode) {
  build("sv2@3?lss");
  auto change = everybody();
  change.all = false;
  const auto out = run(change);
  EXPECT_FALSE(out.error) << out.error->message.text();
  EXPECT_TRUE(out.address);
  EXPECT_EQ(bitrate(), 250'000U);
}

TEST_F(LssBitrate, WhereNoSlaveTookItTheInterfaceGoesBackToThem) {
  build("gsd600@3,sv2@4?lss");
  for (const auto& drive : drives) drive->ignores = true;
  const auto out = run(everybody());
  ASSERT_TRUE(out.error);
  EXPECT_EQ(out.error->code, Errc::negative);
  EXPECT_NE(out.error->message.text().find("still answer at 500 kbit/s"), std::string::npos)
      << out.error->message.text();
  EXPECT_EQ(bitrate(), 500'000U);
  EXPECT_TRUE(link->now.up);
  EXPECT_TRUE(all_wait());
}

TEST_F(LssBitrate, AnotherMasterAtWorkIsTheErrorAndTheInterfaceStays) {
  build("gsd600@3?lss");
  follower = plan(everybody());
  hooks.change_answer = [&](can::Frame& frame) {
    if (drives[0]->rate == 250'000) frame.id = canopen::kLssRequest;
  };
  const auto out = set_lss_bitrate(desk, everybody(), follower);
  ASSERT_TRUE(out && out->error);
  EXPECT_NE(out->error->message.text().find("whether the LSS slaves are was not seen"), std::string::npos)
      << out->error->message.text();
  EXPECT_EQ(bitrate(), 250'000U) << "where the slaves are";
}

TEST_F(LssBitrate, OneThatStayedIsTold) {
  build("gsd600@3,sv2@4?lss");
  drives[1]->ignores = true;
  const auto out = run(everybody());
  ASSERT_TRUE(out.error);
  EXPECT_EQ(out.error->message.text(), "of 2 LSS slaves 1 answer at 250 kbit/s");
  EXPECT_EQ(bitrate(), 250'000U) << "where most of them are";
}

TEST_F(LssBitrate, AnInterfaceThatCannotFollowSaysWhereTheSlavesAre) {
  build("gsd600@3?lss");
  link->refuses = [](const can::LinkChange& change) { return change.bitrate == 250'000U ? EINVAL : 0; };
  const auto out = run(everybody());
  ASSERT_TRUE(out.error);
  EXPECT_NE(out.error->message.text().find("the LSS slaves are at 250 kbit/s now, and can0 could not follow"),
            std::string::npos)
      << out.error->message.text();
  EXPECT_EQ(bitrate(), 500'000U);
}

TEST_F(LssBitrate, CtrlCBehindTheActivationIsHeardWhenTheInterfaceHasFollowed) {
  build("gsd600@3?lss");
  session->options().cancelled = [&] { return drives[0]->activated; };
  const auto out = run(everybody());
  ASSERT_TRUE(out.error);
  EXPECT_EQ(out.error->code, Errc::interrupted);
  EXPECT_EQ(bitrate(), 250'000U);
  EXPECT_NE(out.error->message.text().find("can0 is at 250 kbit/s now"), std::string::npos)
      << out.error->message.text();
}

TEST_F(LssBitrate, CtrlCBeforeTheActivationLeavesAllAsItWas) {
  build("gsd600@3?lss");
  auto change = everybody();
  follower = plan(change);
  bool asked = false;
  hooks.before_request = [&](int) { asked = true; };
  session->options().cancelled = [&] { return asked; };
  const auto out = set_lss_bitrate(desk, change, follower);
  ASSERT_FALSE(out);
  EXPECT_EQ(out.error().code, Errc::interrupted);
  EXPECT_TRUE(link->done.empty());
  EXPECT_TRUE(all_wait());
}

TEST_F(LssBitrate, LeavesAnInterfaceAloneThatWouldLeaveSomebodyBehind) {
  build("gsd600@3,sv2@4?lss");
  auto one = everybody();
  one.all = false;
  one.address = address(*cell.drives[0]);
  const auto out = plan(one);
  EXPECT_FALSE(out.follows());
  EXPECT_NE(out.why_not.find("node 4 would be left at 500 kbit/s"), std::string::npos) << out.why_not;
  EXPECT_TRUE(all_wait());
}

TEST_F(LssBitrate, OneThatIsStoppedIsNotLeftBehindEither) {
  build("gsd600@3,sv2@4?lss");
  auto one = everybody();
  one.all = false;
  one.address = address(*cell.drives[0]);
  (void)bus.send(*can::parse_frame("000#0204"));
  const auto out = plan(one);
  EXPECT_NE(out.why_not.find("node 4 would be left at 500 kbit/s"), std::string::npos) << out.why_not;
}

TEST_F(LssBitrate, TheOtherDriveOfTheSameNumberIsNotLeftBehindEither) {
  build("gsd600@3?lss");
  const auto second = sim::build_cell("sv2@3", kFolders, bus.now()).value();
  drives.push_back(std::make_unique<TunedDrive>(*second.drives[0], link));
  bus.attach(*drives.back());
  const auto out = plan(everybody());
  EXPECT_NE(out.why_not.find("two drives are node 3"), std::string::npos) << out.why_not;
  EXPECT_TRUE(all_wait());
}

TEST_F(LssBitrate, ASlaveWithoutANodeIdIsNotLeftBehindEither) {
  build("gsd600@3,sv2@255?lss");
  auto one = everybody();
  one.all = false;
  one.address = address(*cell.drives[0]);
  const auto out = plan(one);
  EXPECT_NE(out.why_not.find("without a node-ID would be left"), std::string::npos) << out.why_not;
}

TEST_F(LssBitrate, TheInterfaceNeedsTheRightAndTimeAndABitrateOfItsOwn) {
  build("gsd600@3?lss");
  auto out = plan_lss_switch(std::move(owned), everybody(), false);
  ASSERT_TRUE(out);
  EXPECT_NE(out->why_not.find("CAP_NET_ADMIN"), std::string::npos) << out->why_not;
  out = plan_lss_switch(std::move(out->link), everybody(10), true);
  ASSERT_TRUE(out);
  EXPECT_NE(out->why_not.find("10 ms are too short"), std::string::npos) << out->why_not;
  auto same = everybody();
  same.bitrate = 500'000;
  out = plan_lss_switch(std::move(out->link), same, true);
  ASSERT_TRUE(out);
  EXPECT_EQ(out->why_not, "it has 500 kbit/s already");
  auto later = everybody();
  later.delay_ms.reset();
  out = plan_lss_switch(std::move(out->link), later, true);
  ASSERT_TRUE(out);
  EXPECT_EQ(out->link, nullptr);
}

}  // namespace
}  // namespace servoctl::settings
