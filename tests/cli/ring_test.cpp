// Commands on a ring of simulated EtherCAT slaves: what they say, and what they leave alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <set>
#include <string>

#include "cli/admission.hpp"
#include "command/registry.hpp"
#include "drive/standard_objects.hpp"
#include "ethercat/registers.hpp"
#include "session/scan.hpp"
#include "show/notice.hpp"
#include "sim/esc_cell.hpp"
#include "tests/session/ethercat_world.hpp"
#include "tests/show/audiences.hpp"

namespace servoctl::cli {
namespace {

using command::Arguments;
using session::NodeState;
using sim::EscState;
using std::chrono::milliseconds;
using Words = std::initializer_list<std::pair<std::string_view, std::string>>;

class Ring : public session::EtherCatTest {
 protected:
  /// One slave that is not as it should be.
  void open_with(sim::SiiFault fault, std::uint16_t alias = 0) {
    sim::EscCell cell;
    cell.profiles.push_back(std::make_unique<drive::Profile>(drive::load_profile("sv2", folders()).value()));
    cell.memory = std::make_unique<sim::Memory>();
    auto options = sim::EscSlave::Options::of(*cell.profiles.front());
    options.sii = fault;
    options.alias = alias;
    cell.slaves.push_back(
        std::make_unique<sim::EscSlave>(*cell.profiles.front(), 1, *cell.memory, "1", options));
    const sim::SimClock clock(sim::SimClock::Kind::virtual_time);
    cell.ring.attach(*cell.slaves.back(), clock.now());
    port_ = std::make_unique<sim::SimPort>(std::move(cell), clock);
    session_ = connect();
  }
  static std::vector<std::filesystem::path> folders() {
    return {std::filesystem::path(source_dir()) / "eds"};
  }

  /// Runs one command as the shell does; its notices and errors are in `context`.
  std::string run(std::string_view path, std::vector<std::uint8_t> nodes = {}, Words words = {}) {
    return run_on(*session_, path, std::move(nodes), words);
  }
  std::string run_on(session::Session& session, std::string_view path, std::vector<std::uint8_t> nodes,
                     Words words = {}) {
    Arguments arguments;
    for (const auto& [name, value] : words) arguments.add(name, value);
    context = {};
    context.session = &session;
    context.drive_folders = folders();
    context.nodes_typed = !nodes.empty();
    context.nodes = std::move(nodes);
    context.audience = audience;
    const auto* found = command::find_command(path);
    EXPECT_TRUE(check_network(*found, session)) << path;
    const auto done = found->run(context, arguments);
    if (!done) context.errors.push_back(done.error());
    return done ? report::to_json(*done) : done.error().message;
  }
  bool notes(std::string_view text) const {
    return std::any_of(context.notices.begin(), context.notices.end(),
                       [&](const auto& line) { return line.find(text) != std::string::npos; });
  }
  std::string notices() const {
    std::string out;
    for (const auto& notice : context.notices) out += notice + "\n";
    for (const auto& error : context.errors) out += error.message + "; " + error.hint + "\n";
    return out;
  }
  void energise() {
    for (const auto word : {6U, 7U, 15U})
      ASSERT_TRUE(session_->download(1, objects::kControlword, store_le(word, 2)));
    pass(milliseconds(200));
    ASSERT_TRUE(drive::is_energised(slave().model().power_state()));
  }
  std::uint16_t station(std::size_t index = 0) {
    Bytes out(2);
    (void)slave(index).registers().read(ethercat::reg::kStationAddress, out);
    return static_cast<std::uint16_t>(load_le(out));
  }

  command::Context context;
  show::Willing willing;
  show::Unwilling unwilling;
  show::Audience* audience = &willing;
};

TEST_F(Ring, AScanLeavesItAsItIs) {
  open("sv2@1,sv2@2");
  const auto said = run("scan");
  EXPECT_NE(said.find(R"("node":2,"station":0,"alias":0,"vendor_id":4478547)"), std::string::npos) << said;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(slave(i).state(), EscState::init);
    EXPECT_EQ(station(i), 0U);
  }
  EXPECT_EQ(context.notices, std::vector<std::string>{});
}

TEST_F(Ring, AllNodesAreThePlacesOnIt) {
  open("sv2@1,sv2@2,sv2@3");
  EXPECT_EQ(session::nodes_present(*session_).value(), (std::vector<std::uint8_t>{1, 2, 3}));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(slave(i).state(), EscState::init);
}

TEST_F(Ring, ObjectsAreReadInPreOpOnly) {
  open("sv2@1,sv2@2");
  ASSERT_TRUE(session_->upload(2, objects::kDeviceType));
  const auto said = run("scan");
  EXPECT_NE(said.find(R"("node":2,"station":4098)"), std::string::npos) << said;
  EXPECT_NE(said.find(R"("device_type":262546,"device_name":"DSX00E")"), std::string::npos) << said;
  EXPECT_EQ(slave(0).state(), EscState::init);
}

TEST_F(Ring, ObjectsAreLeftAloneWhereAnotherMasterGaveTheAddresses) {
  open("sv2@1");
  ASSERT_TRUE(session_->upload(1, objects::kDeviceType));
  const Bytes address{0x34, 0x12};
  ASSERT_TRUE(slave().registers().write(ethercat::reg::kStationAddress, address));
  session_ = connect();
  const auto said = run("scan");
  EXPECT_NE(said.find(R"("device_type":null)"), std::string::npos) << said;
  EXPECT_EQ(station(), 0x1234U);
}

TEST_F(Ring, ARingOfAnotherMasterIsLookedAtAndToldSo) {
  open("sv2@1,sv2@2");
  network().learn(2, rules());
  ASSERT_TRUE(network().request_state(2, NodeState::operational));
  const auto other = connect();
  const auto said = run_on(*other, "scan", {});
  EXPECT_TRUE(notes("another master works with this ring: node 2 is in OP. It was only looked at"))
      << notices();
  EXPECT_NE(said.find(R"("vendor_id":null)"), std::string::npos) << said;
  EXPECT_EQ(slave(1).state(), EscState::op);
  const auto info = run_on(*other, "info", {1});
  ASSERT_EQ(context.errors.size(), 1U) << info;
  EXPECT_EQ(context.errors.front().message, "node 1: another master works with this ring: node 2 is in OP");
}

TEST_F(Ring, WhatServoctlItselfHoldsInOpIsNoOtherMasters) {
  open("sv2@1");
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  const auto said = run("scan");
  EXPECT_FALSE(notes("another master")) << notices();
  EXPECT_NE(said.find(R"("vendor_id":4478547)"), std::string::npos) << said;
  EXPECT_EQ(slave().state(), EscState::op);
}

TEST_F(Ring, AnEmptySiiIsToldAndTheRestIsShown) {
  open_with(sim::SiiFault::blank);
  const auto said = run("scan");
  EXPECT_TRUE(notes("node 1: SII: it is empty")) << notices();
  EXPECT_NE(said.find(R"("vendor_id":null)"), std::string::npos) << said;
  EXPECT_NE(said.find(R"("coe":null)"), std::string::npos) << said;
}

TEST_F(Ring, AWrongChecksumIsTold) {
  open_with(sim::SiiFault::checksum);
  const auto said = run("scan");
  EXPECT_TRUE(notes("node 1: SII: the checksum of its first words is")) << notices();
  EXPECT_NE(said.find(R"("sii_doubts":["the checksum)"), std::string::npos) << said;
}

TEST_F(Ring, AnAliasIsShown) {
  open_with(sim::SiiFault::none, 0x0102);
  EXPECT_NE(run("scan").find(R"("alias":258)"), std::string::npos);
}

TEST_F(Ring, ErrorCountersOfPortsAreToldInWords) {
  open("sv2@1");
  for (int i = 0; i < 3; ++i) slave().registers().count_damage(0);
  const auto said = run("scan");
  EXPECT_TRUE(notes("node 1: port 0: 3 bad frames")) << notices();
  EXPECT_NE(said.find(R"("bad_frames":3)"), std::string::npos) << said;
}

TEST_F(Ring, AnErrorOfTheAlStateIsToldInWords) {
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

TEST_F(Ring, StatusAsksTheSlaveAndNotTheMemory) {
  open("sv2@1");
  ASSERT_TRUE(session_->upload(1, objects::kDeviceType));
  const auto before = session_->watch().heartbeats(1);
  EXPECT_NE(run("status", {1}).find(R"("al_state":"PRE-OP")"), std::string::npos);
  EXPECT_GT(session_->watch().heartbeats(1), before);
}

TEST_F(Ring, StatesAreEnteredAndLeft) {
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

TEST_F(Ring, ADriveWithPowerKeepsItsState) {
  open("sv2@1");
  network().learn(1, rules());
  (void)run("state op", {1});
  energise();
  for (const auto* path : {"state init", "state preop", "state safeop"}) {
    (void)run(path, {1});
    ASSERT_EQ(context.errors.size(), 1U) << path;
    EXPECT_EQ(context.errors.front().code, Errc::refused) << path;
    EXPECT_EQ(context.errors.front().hint, "`disable -n 1` first") << path;
  }
  EXPECT_EQ(slave().state(), EscState::op);
  EXPECT_TRUE(drive::is_energised(slave().model().power_state()));
  (void)run("state op", {1});
  EXPECT_TRUE(context.errors.empty()) << "it is there already: " << notices();
  EXPECT_TRUE(drive::is_energised(slave().model().power_state()));
}

TEST_F(Ring, WhatAnotherMasterLeftIsTakenOverWhenThatIsSaid) {
  open("sv2@1");
  network().learn(1, rules());
  (void)run("state op", {1});
  energise();
  const auto other = connect();
  (void)run_on(*other, "state preop", {1});
  ASSERT_EQ(context.errors.size(), 1U);
  EXPECT_EQ(context.errors.front().code, Errc::refused);
  EXPECT_NE(context.errors.front().hint.find("`state preop --take-over -n 1`"), std::string::npos)
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

TEST_F(Ring, NothingIsTakenOverWhereThereIsNobody) {
  open("sv2@1");
  audience = &unwilling;
  (void)run("state preop", {1}, {{"--take-over", ""}});
  EXPECT_TRUE(context.errors.empty()) << notices();
}

TEST_F(Ring, ADryRunOfAStateSendsNothing) {
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

TEST_F(Ring, ADryRunChangesNothing) {
  open("sv2@1");
  ASSERT_TRUE(session_->upload(1, objects::kDeviceType));
  const auto held = [&](ObjectAddress object) { return slave().model().values().number(object); };
  const auto mode = held(objects::kModeOfOperation);
  const std::pair<std::string_view, Words> lines[] = {{"disable", {}},
                                                      {"quick-stop", {}},
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
    ASSERT_TRUE(done) << path << ": " << done.error().message;
    EXPECT_TRUE(context.errors.empty()) << path << ": " << notices();
    EXPECT_EQ(report::to_json(*done).find("\"frame\""), std::string::npos) << path << report::to_json(*done);
  }
  EXPECT_EQ(slave().state(), EscState::pre_op);
  EXPECT_EQ(held(objects::kModeOfOperation), mode);
  EXPECT_EQ(held(objects::kControlword), 0U);
  EXPECT_EQ(held({0x1600, 0}), 0U);
}

TEST_F(Ring, AWayOutSpeaksOfAlStates) {
  open("sv2@1");
  ASSERT_TRUE(session_->upload(1, objects::kDeviceType));
  slave().faults().mailbox_stays_full = true;
  (void)run("disable", {1});
  EXPECT_TRUE(notes("node 1: it did not answer and was sent the request for PRE-OP")) << notices();
  EXPECT_FALSE(notes("NMT")) << notices();
}

TEST_F(Ring, EventsOfSlavesAreToldInTheirWords) {
  open("sv2@1");
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  (void)session_->take_events();
  slave().plan_fall({.time = session_->now() + milliseconds(50)});
  pass(milliseconds(500));
  const auto events = session_->take_events();
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(show::notice_text(events.front(), nullptr, false, &session_->network()),
            "node 1: AL state is now SAFE-OP");
}

TEST_F(Ring, RefusesWhatIsCansAlone) {
  open("sv2@1");
  for (const auto* path : {"nmt start", "nmt watch", "sync once", "pdo send", "monitor", "replay"}) {
    const auto possible = check_network(*command::find_command(path), *session_);
    ASSERT_FALSE(possible) << path;
    EXPECT_EQ(possible.error().code, Errc::usage) << path;
  }
}

}  // namespace
}  // namespace servoctl::cli
