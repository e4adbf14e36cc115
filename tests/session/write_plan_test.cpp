// In which order the values of a drive are written.
#include "session/write_plan.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

namespace servoctl::session {
namespace {

std::vector<std::string> told(const std::vector<PlannedWrite>& plan) {
  std::vector<std::string> out;
  for (const auto& write : plan) out.push_back(to_string(write.object) + "=" + to_hex(write.data, ""));
  return out;
}

using Steps = std::vector<std::string>;

const Values kPresent{{{0x1800, 1}, {0x81, 0x01, 0, 0x40}},
                      {{0x1800, 2}, {255}},
                      {{0x1A00, 0}, {1}},
                      {{0x1A00, 1}, {0x10, 0, 0x41, 0x60}},
                      {{0x1A00, 2}, {0, 0, 0, 0}}};

Values with(Values values, const Values& other) {
  for (const auto& [object, data] : other) values.insert_or_assign(object, data);
  return values;
}

TEST(PlanOfWrites, WritesEveryEntryInUseBehindACountOfZero) {
  const auto wanted = with(kPresent, {{{0x1A00, 0}, {2}}, {{0x1A00, 2}, {0x20, 0, 0x64, 0x60}}});
  EXPECT_EQ(told(plan_writes(nullptr, kPresent, wanted)),
            (Steps{"0x1800:1=810100C0", "0x1A00:0=00", "0x1A00:1=10004160", "0x1A00:2=20006460",
                   "0x1A00:0=02", "0x1800:1=81010040"}));
}

TEST(PlanOfWrites, SwitchesAPdoOffOnce) {
  const auto wanted = with(kPresent, {{{0x1800, 1}, {0x81, 0x01, 0, 0xC0}}});
  EXPECT_EQ(told(plan_writes(nullptr, kPresent, wanted)), (Steps{"0x1800:1=810100C0"}));
  EXPECT_EQ(told(plan_writes(nullptr, wanted, kPresent)), (Steps{"0x1800:1=81010040"}));
}

TEST(PlanOfWrites, KeepsBit30WhileThePdoIsOff) {
  const auto wanted = with(kPresent, {{{0x1800, 2}, {1}}});
  EXPECT_EQ(told(plan_writes(nullptr, kPresent, wanted)),
            (Steps{"0x1800:1=810100C0", "0x1800:2=01", "0x1800:1=81010040"}));
}

TEST(PlanOfWrites, OpensAMappingByItsCountAloneWhereTheFamilyDoes) {
  drive::Profile profile;
  profile.rules.pdo.disable_by_count = true;
  const auto wanted = with(kPresent, {{{0x1A00, 1}, {0x20, 0, 0x64, 0x60}}, {{0x1800, 2}, {254}}});
  EXPECT_EQ(told(plan_writes(&profile, kPresent, wanted)),
            (Steps{"0x1A00:0=00", "0x1A00:1=20006460", "0x1A00:0=01", "0x1800:2=FE"}));
}

TEST(PlanOfWrites, SwitchesATpdoOffForItsSyncStartValue) {
  const auto present = with(kPresent, {{{0x1800, 6}, {0}}});
  drive::Profile profile;
  profile.rules.pdo.disable_by_count = true;
  EXPECT_EQ(told(plan_writes(&profile, present, with(present, {{{0x1800, 6}, {3}}}))),
            (Steps{"0x1800:1=810100C0", "0x1800:6=03", "0x1800:1=81010040"}));
}

TEST(PlanOfWrites, SwitchesATpdoOffForItsInhibitTimeUnlessTheFamilyNeedsNot) {
  const auto present = with(kPresent, {{{0x1800, 3}, {0, 0}}});
  const auto wanted = with(present, {{{0x1800, 3}, {100, 0}}});
  const Steps steps{"0x1800:1=810100C0", "0x1800:3=6400", "0x1800:1=81010040"};
  EXPECT_EQ(told(plan_writes(nullptr, present, wanted)), steps);
  drive::Profile profile;
  profile.rules.pdo.disable_by_count = true;
  EXPECT_EQ(told(plan_writes(&profile, present, wanted)), steps);
  profile.rules.pdo.inhibit_while_valid = true;
  EXPECT_EQ(told(plan_writes(&profile, present, wanted)), (Steps{"0x1800:3=6400"}));
}

TEST(PlanOfWrites, ClearsAMappingByItsCountAlone) {
  const auto wanted = with(kPresent, {{{0x1800, 1}, {0x81, 0x01, 0, 0xC0}}, {{0x1A00, 0}, {0}}});
  EXPECT_EQ(told(plan_writes(nullptr, kPresent, wanted)), (Steps{"0x1800:1=810100C0", "0x1A00:0=00"}));
}

/// kPresent beside a second TPDO, valid as well.
Values two_pdos() {
  return with(kPresent,
              {{{0x1801, 1}, {0x81, 0x02, 0, 0}}, {{0x1A01, 0}, {1}}, {{0x1A01, 1}, {0x20, 0, 0x64, 0x60}}});
}

TEST(PlanOfWrites, SwitchesAllPdosOffBeforeItSwitchesOneOn) {
  const auto present = two_pdos();
  const auto wanted = with(
      present, {{{0x1800, 1}, {0x81, 0x02, 0, 0}}, {{0x1801, 1}, {0x81, 0x01, 0, 0x40}}, {{0x1A01, 0}, {0}}});
  const Steps steps{"0x1800:1=810100C0", "0x1801:1=81020080", "0x1A01:0=00", "0x1800:1=81020000",
                    "0x1801:1=81010040"};
  EXPECT_EQ(told(plan_writes(nullptr, present, wanted)), steps);
  drive::Profile profile;
  profile.rules.pdo.disable_by_count = true;
  EXPECT_EQ(told(plan_writes(&profile, present, wanted)), steps);
}

TEST(PlanOfWrites, WritesAddressParametersCommunicationPdosHeartbeatInThisOrder) {
  drive::Profile profile;
  profile.rules.nmt.node_id = "0x2005";
  profile.rules.nmt.bitrate = "0x2007";
  const Values present = with(two_pdos(), {{{0x1016, 1}, {0, 0, 0, 0}},
                                           {{0x1017, 0}, {0, 0}},
                                           {{0x1014, 0}, {0x81, 0, 0, 0x80}},
                                           {{0x2000, 1}, {0, 0}},
                                           {{0x2005, 0}, {3}},
                                           {{0x2007, 0}, {4}},
                                           {{0x607F, 0}, {0}}});
  const Values wanted = with(present, {{{0x1016, 1}, {100, 0, 5, 0}},
                                       {{0x1017, 0}, {100, 0}},
                                       {{0x1014, 0}, {0x82, 0, 0, 0x80}},
                                       {{0x1801, 1}, {0x81, 0x02, 0, 0x80}},
                                       {{0x2000, 1}, {1, 0}},
                                       {{0x2005, 0}, {4}},
                                       {{0x2007, 0}, {5}},
                                       {{0x607F, 0}, {9}}});
  EXPECT_EQ(told(plan_writes(&profile, present, wanted)),
            (Steps{"0x2005:0=04", "0x2007:0=05", "0x2000:1=0100", "0x607F:0=09", "0x1014:0=82000080",
                   "0x1801:1=81020080", "0x1016:1=64000500", "0x1017:0=6400"}));
}

TEST(PlanOfWrites, OpensAnAssignmentByItsCountToo) {
  const Values present{{{0x1C12, 0}, {1}}, {{0x1C12, 1}, {0x01, 0x17}}};
  const Values wanted{{{0x1C12, 0}, {1}}, {{0x1C12, 1}, {0x02, 0x17}}};
  EXPECT_EQ(told(plan_writes(nullptr, present, wanted)),
            (Steps{"0x1C12:0=00", "0x1C12:1=0217", "0x1C12:0=01"}));
}

TEST(PlanOfWrites, LeavesAloneWhatTheDriveDoesNotHave) {
  const auto wanted = with(kPresent, {{{0x1800, 5}, {1, 0}}, {{0x1A00, 3}, {0x20, 0, 0x64, 0x60}}});
  EXPECT_TRUE(plan_writes(nullptr, kPresent, wanted).empty());
}

TEST(WritesForAnyDrive, HoldACobIdThatStandsAlone) {
  const Values wanted{{{0x1400, 1}, store_le(0x201, 4)}};
  const auto writes = plan_writes_for_any_drive(wanted);
  ASSERT_EQ(writes.size(), 1U);
  EXPECT_EQ(writes.front().object, (ObjectAddress{0x1400, 1}));
  EXPECT_EQ(load_le(writes.front().data), 0x201U);
}

}  // namespace
}  // namespace servoctl::session
