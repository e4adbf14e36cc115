// Commands on a ring of simulated EtherCAT slaves: states, ways out and events.
#include "ring_support.hpp"

namespace servoctl::cli {
namespace {

class RingStateTest : public RingTest {};

TEST_F(RingStateTest, AnErrorOfTheAlStateIsToldInWords) {
  open("sv2@1");
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  slave().plan_fall({.time = session_->now() + milliseconds(50), .code = 0x001B});
  pass(milliseconds(500));
  const auto said = run("scan");
  EXPECT_NE(
      said.find(R"("al_state":"SAFE-OP","al_error":true,"al_code":27,"al_text":"sync manager watchdog)"),
      std::string::npos)
      << said;
  EXPECT_TRUE(
      notes("node 1: SAFE-OP, error 0x001B sync manager watchdog: no outputs received in time; process "
            "data did not reach the drive"))
      << notices();
  const auto status = run("status", {1});
  EXPECT_NE(status.find(R"("al_state":"SAFE-OP","al_error":true,"al_code":27)"), std::string::npos) << status;
  EXPECT_EQ(status.find("nmt"), std::string::npos) << status;
}

TEST_F(RingStateTest, StatusAsksTheSlaveAndNotTheMemory) {
  open("sv2@1");
  ASSERT_TRUE(session_->upload(1, objects::kDeviceType));
  const auto before = session_->watch().heartbeats(1);
  EXPECT_NE(run("status", {1}).find(R"("al_state":"PRE-OP")"), std::string::npos);
  EXPECT_GT(session_->watch().heartbeats(1), before);
}

TEST_F(RingStateTest, StatesAreEnteredAndLeft) {
  open("sv2@1");
  network().learn(1, rules());
  EXPECT_NE(run("state op", {1}).find(R"("al_state":"OP")"), std::string::npos) << notices();
  EXPECT_EQ(slave().state(), EscState::op);
  EXPECT_NE(run("status", {1}).find(R"("process_data":{"cycles":)"), std::string::npos);
  (void)run("state safeop", {1});
  EXPECT_EQ(slave().state(), EscState::safe_op);
  EXPECT_TRUE(network().must_go_on()) << "it is held";
  (void)run("state init", {1});
  EXPECT_EQ(slave().state(), EscState::init);
  EXPECT_EQ(context.errors.size(), 0U) << notices();
}

TEST_F(RingStateTest, ADriveWithPowerKeepsItsState) {
  open("sv2@1");
  network().learn(1, rules());
  (void)run("state op", {1});
  energise();
  for (const auto* path : {"state init", "state preop", "state safeop"}) {
    (void)run(path, {1});
    ASSERT_EQ(context.errors.size(), 1U) << path;
    EXPECT_EQ(context.errors.front().code, Errc::refused) << path;
    EXPECT_EQ(context.errors.front().hint.text(), "`disable -n 1` first") << path;
  }
  EXPECT_EQ(slave().state(), EscState::op);
  EXPECT_TRUE(drive::is_energised(slave().model().power_state()));
  (void)run("state op", {1});
  EXPECT_TRUE(context.errors.empty()) << "it is there already: " << notices();
  EXPECT_TRUE(drive::is_energised(slave().model().power_state()));
}

TEST_F(RingStateTest, WhatAnotherMasterLeftIsTakenOverWhenThatIsSaid) {
  open("sv2@1");
  network().learn(1, rules());
  (void)run("state op", {1});
  energise();
  const auto other = connect();
  (void)run_on(*other, "state preop", {1});
  ASSERT_EQ(context.errors.size(), 1U);
  EXPECT_EQ(context.errors.front().code, Errc::refused);
  EXPECT_NE(context.errors.front().hint.text().find("`state preop --take-over -n 1`"), std::string::npos)
      << notices();
  audience = &unwilling;
  (void)run_on(*other, "state preop", {1}, {{"--take-over", ""}});
  EXPECT_EQ(context.errors.size(), 1U) << "it is asked";
  EXPECT_EQ(slave().state(), EscState::op);
  audience = &willing;
  (void)run_on(*other, "state preop", {1}, {{"--take-over", ""}});
  EXPECT_TRUE(context.errors.empty()) << notices();
  EXPECT_EQ(slave().state(), EscState::pre_op);
  EXPECT_FALSE(drive::is_energised(slave().model().power_state()));
}

TEST_F(RingStateTest, NothingIsTakenOverWhereThereIsNobody) {
  open("sv2@1");
  audience = &unwilling;
  (void)run("state preop", {1}, {{"--take-over", ""}});
  EXPECT_TRUE(context.errors.empty()) << notices();
}

TEST_F(RingStateTest, ADryRunOfAStateSendsNothing) {
  open("sv2@1");
  for (const auto* path : {"state init", "state preop", "state safeop", "state op"}) {
    Arguments arguments;
    context = {};
    context.session = session_.get();
    context.nodes = {1};
    context.dry_run = true;
    ASSERT_TRUE(command::find_command(path)->run(context, arguments)) << path;
  }
  EXPECT_EQ(ring().sent(), 0U);
}

TEST_F(RingStateTest, ADryRunChangesNothing) {
  open("sv2@1");
  ASSERT_TRUE(session_->upload(1, objects::kDeviceType));
  const auto held = [&](ObjectAddress object) { return slave().model().values().number(object); };
  const auto mode = held(objects::kModeOfOperation);
  using Line = std::pair<std::string_view, std::vector<std::pair<std::string_view, std::string>>>;
  const std::vector<Line> lines = {{"disable", {}},
                                   {"quick-stop", {}},
                                   {"stop", {}},
                                   {"write", {{"object", "0x6060"}, {"value", "3"}}},
                                   {"mode", {{"mode", "pv"}}},
                                   {"enable", {}},
                                   {"jog", {{"speed", "60rpm"}, {"--for", "1s"}}},
                                   {"pdo preset", {{"preset", "pv"}}},
                                   {"state op", {}}};
  const auto profile = drive::load_profile("sv2", folders()).value();
  for (const auto& [path, words] : lines) {
    Arguments arguments;
    for (const auto& [name, value] : words) arguments.add(name, value);
    context = {};
    context.session = session_.get();
    context.profile = &profile;
    context.nodes = {1};
    context.dry_run = true;
    const auto done = command::find_command(path)->run(context, arguments);
    ASSERT_TRUE(done) << path << ": " << done.error().message.text();
    EXPECT_TRUE(context.errors.empty()) << path << ": " << notices();
    EXPECT_EQ(report::to_json(*done).find("\"frame\":\""), std::string::npos)
        << path << report::to_json(*done);
  }
  EXPECT_EQ(slave().state(), EscState::pre_op);
  EXPECT_EQ(held(objects::kModeOfOperation), mode);
  EXPECT_EQ(held(objects::kControlword), 0U);
  EXPECT_EQ(held({0x1600, 0}), 0U);
}

TEST_F(RingStateTest, AWayOutSpeaksOfAlStates) {
  open("sv2@1");
  ASSERT_TRUE(session_->upload(1, objects::kDeviceType));
  slave().faults().mailbox_stays_full = true;
  (void)run("disable", {1});
  EXPECT_TRUE(notes("node 1: it did not answer and was sent the request for PRE-OP")) << notices();
  EXPECT_FALSE(notes("NMT")) << notices();
}

TEST_F(RingStateTest, EventsOfSlavesAreToldInTheirWords) {
  open("sv2@1");
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  (void)session_->take_events();
  slave().plan_fall({.time = session_->now() + milliseconds(50)});
  pass(milliseconds(500));
  const auto events = session_->take_events();
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(show::notice_text(events.front(), nullptr, false, &session_->network()).text(),
            "node 1: AL state is now SAFE-OP");
}

TEST_F(RingStateTest, RefusesWhatIsCansAlone) {
  open("sv2@1");
  for (const auto* path : {"nmt start", "nmt watch", "sync once", "pdo send", "monitor", "replay"}) {
    const auto possible = check_network(*command::find_command(path), *session_);
    ASSERT_FALSE(possible) << path;
    EXPECT_EQ(possible.error().code, Errc::usage) << path;
  }
}

}  // namespace
}  // namespace servoctl::cli
