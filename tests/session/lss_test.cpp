// servoctl as the LSS master of simulated drives, in virtual time.
#include <set>

#include "lss_world.hpp"
#include "scripted_bus.hpp"
#include "session/can_network.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;
using canopen::LssAddress;
using canopen::LssService;

class Lss : public LssWorld {
 protected:
  static constexpr const char* kTen =
      "sv2@255,sv2@255,sv2@255,sv2@255,sv2@255,sv2@255,sv2@255,sv2@255,sv2@255,sv2@255?lss";
  /// Serial numbers with ones and zeros everywhere.
  void build_ten() {
    cell = sim::build_cell(kTen, kFolders, bus.now()).value();
    std::uint32_t serial = 0x9E3779B9;
    for (const auto& drive : cell.drives) drive->model().set_serial(serial *= 2654435761U);
    for (const auto& drive : cell.drives) bus.attach(*drive);
    session = std::make_unique<Session>(std::make_unique<LssBus>(bus, hooks), "can0", Options{});
  }
};

TEST_F(Lss, FastscanFindsTenSlavesWithoutANodeId) {
  build_ten();
  const auto begun = session->now();
  {
    LssDialogue lss(*session, 50ms);
    const auto found = lss.scan();
    ASSERT_TRUE(found) << found.error().message.text();
    ASSERT_EQ(found->size(), 10U);
    std::set<std::uint32_t> serials, told;
    for (const auto& drive : cell.drives) serials.insert(address(*drive).serial);
    for (const auto& each : *found) {
      EXPECT_EQ(each.slaves, 1U);
      EXPECT_EQ(each.address.vendor, 0x00445653U);
      told.insert(each.address.serial);
    }
    EXPECT_EQ(told, serials);
  }
  // Vendor, product and revision once for all, a step for each half, silences asked twice; five to confirm
  // each.
  EXPECT_EQ(hooks.requests, 1235);
  RecordProperty("milliseconds", static_cast<int>((session->now() - begun) / 1ms));
  EXPECT_LT(session->now() - begun, 25s);
  EXPECT_GT(session->now() - begun, 10s) << "each bit that is 1 costs 50 ms";
  EXPECT_TRUE(all_wait());
}

/// Every third, for the time it takes; all of them pass.
TEST_F(Lss, FindsEverySlaveWhateverSingleFrameIsLost) {
  build("sv2@255,da200@255?lss");
  const auto scan = [&] {
    LssDialogue lss(*session, 20ms);
    const auto found = lss.scan();
    EXPECT_TRUE(found) << found.error().message.text();
    return found ? found->size() : 0;
  };
  EXPECT_EQ(scan(), 2U);
  const int requests = hooks.requests, answers = hooks.answers;
  for (int i = 0; i < requests; i += 3) {
    SCOPED_TRACE(i);
    hooks = {.lose_request = i};
    ASSERT_EQ(scan(), 2U);
    ASSERT_TRUE(all_wait());
  }
  for (int i = 1; i < answers; i += 3) {
    SCOPED_TRACE(i);
    hooks = {.lose_answer = i};
    ASSERT_EQ(scan(), 2U);
    ASSERT_TRUE(all_wait());
  }
}

class LssLiar : public testing::Test {
 protected:
  /// Every request that is answered at all has an answer here.
  std::unique_ptr<ScriptedBus> wire() {
    auto bus = std::make_unique<ScriptedBus>();
    bus->on_send = [this](ScriptedBus& at, const std::string& sent) {
      ++requests;
      if (sent.starts_with("7E5#51") || sent.starts_with("7E5#4B")) at.arrive("7E4#4F00000000000000");
    };
    return bus;
  }
  int requests = 0;
  Session session{wire(), "can0", Options{}};
  LssDialogue lss{session, 50ms};
};

TEST_F(LssLiar, IsNoticedBeforeAScanWalksItsFirstIdentity) {
  const auto found = lss.scan();
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, Errc::negative);
  EXPECT_EQ(found.error().message.text(), "an LSS slave answers to whatever identity is asked for");
  EXPECT_LT(requests, 100);
}

TEST_F(LssLiar, EndsASearchByIdentity) {
  const auto found = lss.search({1, 2, 0, 0}, {1, 2, 0xFFFF'FFFF, 0xFFFF'FFFF});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().message.text(), "an LSS slave answers to whatever identity is asked for");
  EXPECT_LT(requests, 10'000);
}

TEST_F(Lss, LeavesAllWaitingWhereverItIsInterrupted) {
  build("sv2@255,sv2@255?lss");
  bool stop = false;
  session->options().cancelled = [&] { return stop; };
  for (int at = 0; at < 280; at += 7) {
    hooks = {};
    hooks.before_request = [&](int request) { stop = stop || request == at; };
    {
      LssDialogue lss(*session, 20ms);
      const auto found = lss.scan();
      if (at < 260) {
        ASSERT_FALSE(found) << at;
        EXPECT_EQ(found.error().code, Errc::interrupted);
      }
    }
    stop = false;
    EXPECT_TRUE(all_wait()) << at;
  }
}

TEST_F(Lss, LeavesASelectedSlaveWaitingWhereverItIsInterrupted) {
  build("sv2@3,sv2@4?lss");
  bool stop = false;
  session->options().cancelled = [&] { return stop; };
  for (int at = 0; at < 12; ++at) {
    hooks = {};
    hooks.before_request = [&](int request) { stop = stop || request == at; };
    {
      LssDialogue lss(*session, 20ms);
      auto done = lss.select(LssAddress{0x00445653, 1, 1, 2});
      const auto set = done ? lss.order(canopen::lss_set_node(9), "set its node-ID") : fail(done.error());
      EXPECT_EQ(set.has_value(), at > 10) << at;
    }
    stop = false;
    EXPECT_TRUE(all_wait()) << at;
  }
}

TEST_F(Lss, ASecondCtrlCWaitsUntilAllAreBack) {
  build("sv2@3?lss");
  std::vector<Care> seen;
  Protection protection([&](Care worst) { seen.push_back(worst); });
  session->options().protection = &protection;
  {
    LssDialogue lss(*session, 20ms);
    EXPECT_TRUE(seen.empty());
    ASSERT_TRUE(lss.select({}));
    EXPECT_EQ(protection.worst(), Care::guarded);
  }
  EXPECT_EQ(protection.worst(), Care::none);
}

TEST_F(Lss, SelectsByIdentityAndAsksWhoItIs) {
  build("sv2@3,sv2@4?lss");
  LssDialogue lss(*session, 50ms);
  const auto slave = lss.select(LssAddress{0x00445653, 1, 1, 2});
  ASSERT_TRUE(slave) << slave.error().message.text();
  EXPECT_EQ(slave->node, 4);
  const auto nobody = lss.select(LssAddress{0x00445653, 1, 1, 3});
  ASSERT_FALSE(nobody);
  EXPECT_EQ(nobody.error().code, Errc::timeout);
}

TEST_F(Lss, TwoThatAnswerAreNoticed) {
  build("sv2@3,sv2@4?lss");
  LssDialogue lss(*session, 50ms);
  const auto only = lss.select({});
  ASSERT_FALSE(only);
  EXPECT_EQ(only.error().code, Errc::refused);
  EXPECT_TRUE(lss.leave());
  EXPECT_TRUE(all_wait());
}

TEST_F(Lss, TwoOfOneIdentityAreNoticedBySelectionAndByFastscan) {
  cell = sim::build_cell("sv2@255,sv2@255?lss", kFolders, bus.now()).value();
  for (const auto& drive : cell.drives) drive->model().set_serial(7);
  for (const auto& drive : cell.drives) bus.attach(*drive);
  session = std::make_unique<Session>(std::make_unique<LssBus>(bus, hooks), "can0", Options{});
  LssDialogue lss(*session, 50ms);
  const auto found = lss.scan();
  ASSERT_TRUE(found && found->size() == 1U);
  EXPECT_EQ(found->front().slaves, 2U);
  const auto slave = lss.select(found->front().address);
  ASSERT_FALSE(slave);
  EXPECT_EQ(slave.error().code, Errc::refused);
}

TEST_F(Lss, ASlaveThatSaysItIsAnotherIsNotBelieved) {
  build("sv2@3?lss");
  hooks.change_answer = [](can::Frame& frame) {
    if (frame.data[0] == 0x5D) frame.data[1] ^= 1U;
  };
  LssDialogue lss(*session, 50ms);
  const auto slave = lss.select(LssAddress{0x00445653, 1, 1, 1});
  ASSERT_FALSE(slave);
  EXPECT_EQ(slave.error().code, Errc::protocol);
}

/// CANopenNode's slaves do: they would be found for ever.
TEST_F(Lss, ASlaveThatAnswersEveryStepInTheConfigurationStateDoesNotDisturbTheScan) {
  struct Node final : sim::Device {
    explicit Node(sim::SimDrive& drive) : drive_(&drive) {}
    void on_frame(const can::Frame& frame, TimePoint now) override {
      if (frame.id == canopen::kLssRequest && frame.data[0] == 0x51 && configures) {
        tx = can::parse_frame("7E4#4F00000000000000");
        return;
      }
      drive_->on_frame(frame, now);
    }
    void on_time(TimePoint now) override { drive_->on_time(now); }
    std::optional<can::Frame> take_frame() override {
      if (tx) return std::exchange(tx, std::nullopt);
      auto frame = drive_->take_frame();
      if (frame && frame->data[0] == 0x44) configures = true;
      return frame;
    }
    TimePoint deadline() const override { return drive_->deadline(); }
    sim::SimDrive* drive_;
    std::optional<can::Frame> tx;
    bool configures = false;
  };
  cell = sim::build_cell("sv2@255,sv2@255?lss", kFolders, bus.now()).value();
  Node one(*cell.drives[0]), other(*cell.drives[1]);
  bus.attach(one);
  bus.attach(other);
  session = std::make_unique<Session>(std::make_unique<LssBus>(bus, hooks), "can0", Options{});
  LssDialogue lss(*session, 20ms);
  const auto found = lss.scan();
  ASSERT_TRUE(found) << found.error().message.text();
  EXPECT_EQ(found->size(), 2U);
}

TEST_F(Lss, ARefusalIsToldInWordsAndASilenceIsNone) {
  build("sv2@3?lss");
  LssDialogue lss(*session, 50ms);
  ASSERT_TRUE(lss.select({}));
  const auto refused = lss.order(canopen::lss_set_node(200), "set its node-ID");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::negative);
  EXPECT_NE(refused.error().message.text().find("the node-ID is out of its range"), std::string::npos);
  ASSERT_TRUE(lss.leave());
  const auto silent = lss.order(canopen::lss_set_node(5), "set its node-ID");
  ASSERT_FALSE(silent);
  EXPECT_EQ(silent.error().code, Errc::timeout);
}

TEST_F(Lss, TellsASlaveThatDoesNotGoBackToWaiting) {
  build("sv2@3?lss");
  hooks.after_request = [&] {
    (void)bus.send(canopen::lss_switch_all(canopen::LssState::configuration).frames.front());
  };
  LssDialogue lss(*session, 20ms);
  ASSERT_TRUE(lss.select_all());
  const auto left = lss.leave();
  ASSERT_FALSE(left);
  EXPECT_EQ(left.error().code, Errc::negative);
}

TEST_F(Lss, AnotherMasterIsNoticed) {
  build("sv2@3?lss");
  LssDialogue lss(*session, 50ms);
  ASSERT_TRUE(lss.select({}));
  struct Other final : sim::Device {
    void on_frame(const can::Frame&, TimePoint) override { asks = true; }
    void on_time(TimePoint) override {}
    std::optional<can::Frame> take_frame() override {
      if (!std::exchange(asks, false) || done) return std::nullopt;
      done = true;
      return canopen::lss_inquire(LssService::inquire_vendor).frames.front();
    }
    TimePoint deadline() const override { return kNever; }
    bool asks = false, done = false;
  } other;
  bus.attach(other);
  const auto answers = lss.ask(canopen::lss_inquire(LssService::inquire_node));
  ASSERT_FALSE(answers);
  EXPECT_EQ(answers.error().code, Errc::refused);
  EXPECT_TRUE(lss.leave());
}

TEST_F(Lss, SearchFindsEverySlaveOfAKindWithANodeIdAndWithout) {
  cell = sim::build_cell("sv2@3,sv2@255,sv2@255,da200@5?lss", kFolders, bus.now()).value();
  const std::uint32_t serials[] = {0, 0xFFFFFFFF, 0x80000000, 5};
  for (std::size_t i = 0; i < 4; ++i) cell.drives[i]->model().set_serial(serials[i]);
  for (const auto& drive : cell.drives) bus.attach(*drive);
  session = std::make_unique<Session>(std::make_unique<LssBus>(bus, hooks), "can0", Options{});
  LssDialogue lss(*session, 20ms);
  const auto found = lss.search({0x00445653, 1, 0, 0}, {0x00445653, 1, 0xFFFFFFFF, 0xFFFFFFFF});
  ASSERT_TRUE(found) << found.error().message.text();
  const std::vector<LssAddress> expected{
      {0x00445653, 1, 1, 0}, {0x00445653, 1, 1, 0x80000000}, {0x00445653, 1, 1, 0xFFFFFFFF}};
  EXPECT_EQ(*found, expected);
}

}  // namespace
}  // namespace servoctl::session
