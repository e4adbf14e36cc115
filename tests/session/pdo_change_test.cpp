// A change of PDOs ends with the new mapping, or with the old one and the NMT state put back, or says what is
// neither: whatever step a drive of whatever family refuses, at silence, and at Ctrl-C.
#include "session/pdo_change.hpp"

#include <functional>

#include "pdo_world.hpp"

namespace servoctl::session {
namespace {

using canopen::NmtState;
using canopen::Pdo;

/// A change of every kind: another mapping, another type, switched on, switched off, COB-IDs exchanged where
/// the family lets them change.
struct PdoWish {
  std::vector<Pdo> pdos;
  Values assignments;
};

bool has_cob_ids(const PdoWorld& world) {
  return !assignment_of(&world.profile(), canopen::PdoDirection::receive);
}

PdoWish wish_of(PdoWorld& world) {
  PdoWish out;
  if (!has_cob_ids(world)) {
    auto rpdo = world.pdo("RPDO1");
    rpdo.entries = {entry(0x60400010), entry(0x607A0020)};
    out.pdos = {rpdo};
    out.assignments = {{{0x1C12, 0}, {1}}, {{0x1C12, 1}, {0x00, 0x16}}};
    return out;
  }
  auto other_rpdo = world.pdo("RPDO1");
  auto rpdo = world.pdo("RPDO2");
  rpdo.entries = {entry(0x60400010), entry(0x607A0020)};
  rpdo.cob_id &= ~canopen::kPdoInvalid;
  auto tpdo = world.pdo("TPDO1");
  tpdo.entries = {entry(0x60640020), entry(0x60410010)};
  tpdo.type = 3;
  if (tpdo.inhibit) tpdo.inhibit = static_cast<std::uint16_t>(*tpdo.inhibit + 50);
  auto other = world.pdo("TPDO2");
  other.cob_id ^= canopen::kPdoInvalid;
  if ((world.profile().rules.pdo.cob_id_bits & 0x7FFU) != 0) std::swap(other_rpdo.cob_id, rpdo.cob_id);
  out.pdos = {other_rpdo, rpdo, tpdo, other};
  return out;
}

class EveryFamily : public testing::TestWithParam<const char*> {
 protected:
  static constexpr std::uint8_t kNode = 5;
  std::unique_ptr<PdoWorld> world() {
    auto out = std::make_unique<PdoWorld>(PdoWorld::profile_of(GetParam()), kNode);
    EXPECT_EQ(out->drive().nmt_state(), NmtState::operational);
    return out;
  }
  using Expect = std::function<void(PdoWorld& world, const RestoreOutcome& outcome, const Values& before,
                                    const PdoWish&)>;
  /// Changes a new drive once for every SDO request of the change, with trouble at that one.
  void at_every_step(int StepTrouble::*kind, const Expect& expect) {
    int steps = 1;
    for (int step = -1; step < steps; ++step) {
      SCOPED_TRACE(step);
      auto world = this->world();
      const auto wish = wish_of(*world);
      const auto before = world->read();
      StepTrouble trouble;
      trouble.*kind = step;
      const auto outcome = world->change(wish.pdos, trouble, wish.assignments);
      EXPECT_FALSE(world->shared_cob_id);
      if (step >= 0)
        expect(*world, outcome, before, wish);
      else
        steps = world->requests;
    }
    EXPECT_GT(steps, 8);
  }
};

/// The promise: never a value that is neither as wanted, nor as it was, nor told.
void expect_kept(PdoWorld& world, const RestoreOutcome& outcome, const Values& before, const PdoWish& wish) {
  const auto now = world.read();
  if (!outcome.failure) {
    for (const auto& pdo : wish.pdos) EXPECT_EQ(world.pdo(canopen::name(pdo.direction, pdo.number)), pdo);
    for (const auto& [object, data] : wish.assignments) EXPECT_EQ(now.at(object), data);
    return;
  }
  EXPECT_EQ(outcome.rolled_back, outcome.astray.empty());
  if (!outcome.rolled_back) return;
  EXPECT_EQ(now, before) << outcome.failure->message.text();
  EXPECT_EQ(world.drive().nmt_state(), NmtState::operational);
}

TEST_P(EveryFamily, GetsTheNewMappingAndItsNmtStateBack) {
  auto world = this->world();
  const auto wish = wish_of(*world);
  const auto before = world->read();
  const auto outcome = world->change(wish.pdos, {}, wish.assignments);
  ASSERT_FALSE(outcome.failure) << outcome.failure->message.text();
  EXPECT_TRUE(outcome.notices.empty() || std::string_view(GetParam()) == "ts" ||
              std::string_view(GetParam()) == "sv2");
  expect_kept(*world, outcome, before, wish);
  EXPECT_EQ(world->drive().nmt_state(), NmtState::operational);
}

TEST_P(EveryFamily, HasItsOldMappingAfterARefusalAtAnyStep) {
  at_every_step(&StepTrouble::refused,
                [](auto& world, const auto& outcome, const auto& before, const auto& wish) {
                  expect_kept(world, outcome, before, wish);
                  // A drive need not have what tells its NMT state: 1017h, 100Ch, 100Dh.
                  EXPECT_EQ(outcome.failure.has_value(), world.refused > 0x1017);
                  if (!outcome.failure) return;
                  EXPECT_EQ(outcome.failure->code, Errc::sdo_abort);
                  EXPECT_TRUE(outcome.rolled_back);
                });
}

TEST_P(EveryFamily, HasItsOldMappingAfterCtrlCAtAnyStep) {
  at_every_step(&StepTrouble::cancelled,
                [](auto& world, const auto& outcome, const auto& before, const auto& wish) {
                  ASSERT_TRUE(outcome.failure);
                  EXPECT_EQ(outcome.failure->code, Errc::interrupted);
                  EXPECT_TRUE(outcome.rolled_back);
                  expect_kept(world, outcome, before, wish);
                });
}

TEST_P(EveryFamily, IsToldOfWhenItFallsSilentAtAnyStep) {
  at_every_step(&StepTrouble::silent, [](auto& world, const auto& outcome, const auto& before, const auto&) {
    ASSERT_TRUE(outcome.failure);
    EXPECT_TRUE(!outcome.rolled_back || world.sent.empty());
    const auto now = world.read();
    for (const auto& [object, data] : before) {
      const bool told = std::count(outcome.astray.begin(), outcome.astray.end(), object) > 0;
      const auto found = now.find(object);
      EXPECT_TRUE(told || (found != now.end() && found->second == data)) << to_string(object);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(PdoChange, EveryFamily, testing::Values("gsd600", "dm", "da200", "ts", "sv2"),
                         [](const auto& family) { return std::string(family.param); });

drive::Profile changed_outside_operational() {
  auto out = PdoWorld::profile_of("gsd600");
  out.rules.pdo.mapping = out.rules.pdo.parameters = drive::PdoRules::When::not_operational;
  return out;
}

TEST(PdoChange, LeavesADrivePreOperationalWhereNothingTellsItsState) {
  PdoWorld world(changed_outside_operational(), 1);
  // Life guarding is set up: one question would begin it, and the silence after it would be an alarm.
  auto quiet = world.session({});
  ASSERT_TRUE(quiet.download(1, {0x100C, 0}, {100, 0}));
  ASSERT_TRUE(quiet.download(1, {0x100D, 0}, {3}));
  auto pdo = world.pdo("TPDO2");
  pdo.entries = {entry(0x60640020)};
  const auto outcome = world.change({pdo});
  ASSERT_FALSE(outcome.failure) << outcome.failure->message.text();
  ASSERT_EQ(outcome.notices.size(), 1U);
  EXPECT_NE(outcome.notices[0].text().find("stays pre-operational"), std::string::npos);
  EXPECT_EQ(world.drive().nmt_state(), NmtState::pre_operational);
}

TEST(PdoChange, KnowsTheStateByHeartbeatToo) {
  PdoWorld world(changed_outside_operational(), 1);
  auto quiet = world.session({});
  ASSERT_TRUE(quiet.download(1, {0x1017, 0}, {100, 0}));
  auto pdo = world.pdo("TPDO2");
  pdo.entries = {entry(0x60640020)};
  EXPECT_FALSE(world.change({pdo}).failure);
  EXPECT_EQ(world.sent.front(), "000#8001");
  EXPECT_EQ(world.sent.back(), "000#0101");
  EXPECT_EQ(world.drive().nmt_state(), NmtState::operational);
}

TEST(PdoChange, DoesNotStartADriveThatWasNotOperational) {
  PdoWorld world(changed_outside_operational(), 1);
  auto quiet = world.session({});
  ASSERT_TRUE(quiet.can()->send(canopen::nmt_frame(canopen::NmtCommand::enter_pre_operational, 1)));
  auto pdo = world.pdo("TPDO2");
  pdo.entries = {entry(0x60640020)};
  EXPECT_FALSE(world.change({pdo}).failure);
  EXPECT_TRUE(
      std::none_of(world.sent.begin(), world.sent.end(), [](const auto& f) { return f.starts_with("000"); }));
  EXPECT_EQ(world.drive().nmt_state(), NmtState::pre_operational);
}

TEST(PdoChange, OfAnUnknownDriveIsTriedAgainPreOperational) {
  // An unknown drive with these alarms would be in fault before it is written to.
  auto drive = PdoWorld::profile_of("da200");
  drive.rules.fault.object_alarm.clear();
  drive.rules.fault.sub_index_alarm.clear();
  PdoWorld world(std::move(drive), 1);
  const auto generic = PdoWorld::profile_of("cia402");
  for (const auto* known : {&generic, static_cast<const drive::Profile*>(nullptr)}) {
    world.client_profile = known;
    auto pdo = world.pdo("TPDO2");
    pdo.entries = {entry(pdo.entries.size() == 1 ? 0x60640020 : 0x60410010)};
    const auto outcome = world.change({pdo});
    ASSERT_FALSE(outcome.failure) << outcome.failure->message.text();
    ASSERT_EQ(outcome.notices.size(), 1U);
    EXPECT_NE(outcome.notices[0].text().find("tried again pre-operational"), std::string::npos);
    EXPECT_EQ(world.pdo("TPDO2"), pdo);
    EXPECT_EQ(world.drive().nmt_state(), NmtState::operational);
  }
}

TEST(PdoChange, OfAnUnknownDriveThatIsEnergisedIsNotStoppedForIt) {
  PdoWorld world(PdoWorld::profile_of("dm"), 1);
  world.client_profile = nullptr;
  auto quiet = world.session({});
  for (const unsigned word : {0x06U, 0x07U, 0x0FU}) {
    ASSERT_TRUE(quiet.download(1, {0x6040, 0}, store_le(word, 2)));
    (void)quiet.wait([] { return false; }, quiet.now() + std::chrono::milliseconds(200));
  }
  auto pdo = world.pdo("TPDO2");
  pdo.entries = {entry(0x60640020)};
  const auto outcome = world.change({pdo}, {.refused = 1});
  ASSERT_TRUE(outcome.failure);
  EXPECT_TRUE(outcome.rolled_back);
  for (const auto& frame : world.sent) EXPECT_FALSE(frame.starts_with("000#")) << frame;
  EXPECT_EQ(world.drive().nmt_state(), NmtState::operational);
  EXPECT_EQ(world.drive().power_state(), drive::DriveState::operation_enabled);
}

TEST(PdoChange, OfAnUnknownDriveThatKeepsItsCobIdIsTriedAgainWithout) {
  auto profile = PdoWorld::profile_of("ts");
  profile.dictionary.find({0x1801, 1})->access = od::Access::ro;
  PdoWorld world(profile, 1);
  world.client_profile = nullptr;
  auto pdo = world.pdo("TPDO2");
  pdo.entries = {entry(0x60640020)};
  const auto outcome = world.change({pdo});
  ASSERT_FALSE(outcome.failure) << outcome.failure->message.text();
  ASSERT_FALSE(outcome.notices.empty());
  EXPECT_NE(outcome.notices[0].text().find("with the COB-ID left alone"), std::string::npos);
  EXPECT_EQ(world.pdo("TPDO2"), pdo);
}

/// CiA 301, 7.5.2.37: the inhibit time stays while the PDO is valid.
TEST(PdoChange, TheInhibitTimeOfAValidTpdoIsChangedWhileThePdoIsSwitchedOff) {
  for (const char* family : {"cia402", "gsd600", "dm", "da200", "ts"})
    for (const bool known : {true, false}) {
      SCOPED_TRACE(family);
      PdoWorld world(PdoWorld::profile_of(family), 1);
      auto pdo = world.pdo("TPDO1");
      ASSERT_TRUE(pdo.inhibit);
      pdo.cob_id &= ~canopen::kPdoInvalid;
      ASSERT_FALSE(world.change({pdo}).failure);
      if (!known && std::string_view(family) != "da200") world.client_profile = nullptr;
      pdo.inhibit = static_cast<std::uint16_t>(*pdo.inhibit + 50);
      const auto outcome = world.change({pdo});
      EXPECT_FALSE(outcome.failure) << outcome.failure->message.text();
      EXPECT_EQ(world.pdo("TPDO1"), pdo);
    }
}

TEST(PdoChange, TheInhibitTimeIsAReasonToSwitchATpdoOffWhereMappingsAreOpenedByTheirCount) {
  auto profile = PdoWorld::profile_of("ts");
  profile.rules.pdo.inhibit_while_valid = false;
  PdoWorld world(std::move(profile), 1);
  auto pdo = world.pdo("TPDO1");
  pdo.inhibit = std::uint16_t{100};
  const auto outcome = world.change({pdo});
  EXPECT_FALSE(outcome.failure) << outcome.failure->message.text();
  EXPECT_EQ(world.pdo("TPDO1"), pdo);
}

TEST(PdoChange, TheInhibitTimeIsNoReasonToSwitchATpdoOfTheTsOff) {  // 1771, 1794
  PdoWorld world(PdoWorld::profile_of("ts"), 1);
  auto pdo = world.pdo("TPDO1");
  pdo.inhibit = std::uint16_t{100};
  ASSERT_FALSE(world.change({pdo}).failure);
  // Fn_99 = 1 comes first: the flash is spared.
  EXPECT_EQ(world.sent, (std::vector<std::string>{"601#2B99200001000000", "601#2B00180364000000"}));
}

/// What is read-only is so in every state: the node is not stopped for it.
TEST(PdoChange, AMappingThatIsReadOnlyIsNotTriedPreOperational) {
  auto profile = PdoWorld::profile_of("ts");
  profile.dictionary.find({0x1A01, 0})->access = od::Access::ro;
  PdoWorld world(profile, 1);
  world.client_profile = nullptr;
  auto pdo = world.pdo("TPDO2");
  pdo.entries = {entry(0x60640020)};
  const auto outcome = world.change({pdo});
  ASSERT_TRUE(outcome.failure);
  EXPECT_TRUE(outcome.rolled_back);
  for (const auto& frame : world.sent) EXPECT_FALSE(frame.starts_with("000#")) << frame;
  EXPECT_EQ(world.drive().nmt_state(), NmtState::operational);
}

/// Nothing tells the state but the drive itself: it refused as long as it was operational, and not
/// afterwards.
TEST(PdoChange, ADriveThatRefusedBecauseOfItsStateIsStartedAgain) {
  PdoWorld world(changed_outside_operational(), 1);
  world.client_profile = nullptr;
  auto quiet = world.session({});
  ASSERT_TRUE(quiet.download(1, {0x100C, 0}, {100, 0}));
  ASSERT_TRUE(quiet.download(1, {0x100D, 0}, {3}));
  auto pdo = world.pdo("TPDO2");
  pdo.entries = {entry(0x60640020)};
  const auto outcome = world.change({pdo});
  ASSERT_FALSE(outcome.failure) << outcome.failure->message.text();
  ASSERT_EQ(outcome.notices.size(), 1U) << testing::PrintToString(outcome.notices);
  EXPECT_EQ(world.drive().nmt_state(), NmtState::operational);
}

TEST(PdoChange, OfAKnownDriveIsNotTriedAgain) {
  PdoWorld world(PdoWorld::profile_of("gsd600"), 1);
  auto pdo = world.pdo("TPDO2");
  pdo.entries = {entry(0x60400010)};  // It cannot be sent.
  const auto outcome = world.change({pdo});
  ASSERT_TRUE(outcome.failure);
  EXPECT_TRUE(outcome.rolled_back);
  EXPECT_TRUE(outcome.notices.empty());
}

TEST(PdoChange, GoesBackAlsoWhereTheDriveRefusesToEmptyAnUnusedEntry) {
  PdoWorld world(PdoWorld::profile_of("dm"), 1);
  auto pdo = world.pdo("TPDO1");
  pdo.entries = {entry(0x60410010)};
  ASSERT_FALSE(world.change({pdo}).failure);
  const auto before = world.read();
  auto more = pdo;
  more.entries = {entry(0x60640020), entry(0x60410010)};
  const auto outcome = world.change({more}, {.refused = 6, .refuses_empty_entries = true});
  ASSERT_TRUE(outcome.failure);
  EXPECT_TRUE(outcome.rolled_back);
  EXPECT_EQ(world.read(), before);
}

TEST(PdoChange, IsRefusedWhileTheDriveIsEnergised) {
  PdoWorld world(PdoWorld::profile_of("gsd600"), 1);
  auto quiet = world.session({});
  EXPECT_TRUE(check_not_energised(quiet, 1));
  for (const auto word : {std::uint8_t{6}, std::uint8_t{7}, std::uint8_t{15}}) {
    ASSERT_TRUE(quiet.download(1, {0x6040, 0}, {word, 0}));
    (void)quiet.wait([] { return false; }, quiet.now() + std::chrono::seconds(1));
  }
  const auto refused = check_not_energised(quiet, 1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::refused);
}

TEST(StoredCopies, AreWhatTheDriveCopiesIntoItsObjectsAtItsStart) {
  const auto profile = PdoWorld::profile_of("gsd600");
  Values wanted{{{0x1800, 1}, {0x85, 0x01, 0, 0x40}}, {{0x1A00, 0}, {2}}};
  add_stored_copies(profile, 5, wanted);
  EXPECT_EQ(wanted.at({0x2001, 0x65}), (Bytes{0x80, 0x01, 0, 0x40}));  // Pn0300, without the node-ID (3268).
  EXPECT_EQ(wanted.size(), 4U);
}

}  // namespace
}  // namespace servoctl::session
