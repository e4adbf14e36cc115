// Under which CAN-ID and how often simulated drives send emergencies (CiA 301, 7.5.2.17 and 7.5.2.18).
#include "sim/emergency_producer.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <filesystem>

#include "base/file.hpp"
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

class EmergencyCobId : public DrivenTest, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override { boot(GetParam()); }
  void take(const std::string& request) { ASSERT_EQ(sdo(request).substr(0, 6), "581#60") << request; }
};

std::string name_of_family(const testing::TestParamInfo<const char*>& test) { return test.param; }

TEST_P(EmergencyCobId, IsThatOf1014h) {
  take("601#2314100081000080");  // Bit 31: not valid.
  take("601#23141000F1000000");
  drive().raise_fault(0x2310, {}, bus.now());
  EXPECT_EQ(next().substr(0, 8), "0F1#1023");
}

TEST_P(EmergencyCobId, ThatIsNotValidIsUsedByNone) {
  take("601#2314100081000080");
  drive().raise_fault(0x2310, {}, bus.now());
  EXPECT_EQ(next(100ms), "");
  EXPECT_EQ(drive().power_state(), drive::DriveState::fault) << "it is no less a fault";
  take("601#2314100081000000");
  drive().raise_fault(0x3210, {}, bus.now());
  EXPECT_EQ(next().substr(0, 8), "081#1032");
}

class EmergencyDefault : public DrivenTest, public testing::WithParamInterface<const char*> {};

TEST_P(EmergencyDefault, IsAsPredefinedWhereTheEdsNamesNoneOrThatOfAnotherService) {
  const auto eds = read_file(source_dir() + "/eds/cia/cia402.eds").value();
  const auto begin = eds.find("DefaultValue=", eds.find("[1014]"));
  const auto end = eds.find_first_of("\r\n", begin);
  const auto file = std::filesystem::temp_directory_path() / fmt::format("emcy-{}.eds", ::getpid());
  auto text = eds;
  ASSERT_TRUE(write_file_atomically(file, text.replace(begin, end - begin, GetParam())));
  boot(file.string());
  std::filesystem::remove(file);
  drive().raise_fault(0x2310, {}, bus.now());
  EXPECT_EQ(next().substr(0, 8), "081#1023");
}

INSTANTIATE_TEST_SUITE_P(Values, EmergencyDefault,
                         testing::Values("", "DefaultValue=0", "DefaultValue=0x701"));

INSTANTIATE_TEST_SUITE_P(Families, EmergencyCobId, testing::Values("gsd600", "dm", "ts", "cia402"),
                         name_of_family);

class EmergencyInhibitTime : public EmergencyCobId {};

TEST_P(EmergencyInhibitTime, LiesBetweenTwoEmergencies) {
  take("601#2B151000E8030000");  // 1000 times 100 us.
  drive().raise_fault(0x2310, {}, bus.now());
  drive().raise_fault(0x3210, {}, bus.now());
  EXPECT_EQ(next().substr(0, 8), "081#1023");
  EXPECT_EQ(next(99ms), "");
  EXPECT_EQ(next(2ms).substr(0, 8), "081#1032");
  take("601#2B15100000000000");
  drive().raise_fault(0x2310, {}, bus.now());
  drive().raise_fault(0x3210, {}, bus.now());
  EXPECT_EQ(next().substr(0, 8), "081#1023");
  EXPECT_EQ(next().substr(0, 8), "081#1032");
}

TEST_P(EmergencyInhibitTime, DoesNotOutliveAReset) {
  take("601#2B151000E8030000");
  drive().raise_fault(0x2310, {}, bus.now());
  drive().raise_fault(0x3210, {}, bus.now());
  ASSERT_EQ(next().substr(0, 8), "081#1023");
  send("000#8201");
  EXPECT_EQ(next(60ms), "701#00");
  EXPECT_EQ(next(1s), "");
}

INSTANTIATE_TEST_SUITE_P(Families, EmergencyInhibitTime, testing::Values("dm", "ts", "cia402"),
                         name_of_family);

TEST_F(DrivenTest, AFamilyWithout1014hSendsEmergenciesAsPredefined) {
  boot("da200");
  drive().raise_fault(0x2310, {}, bus.now());
  EXPECT_EQ(next().substr(0, 8), "081#1023");
}

TEST_F(DrivenTest, WhatTheModelTellsByItselfIsSentAtOnceButNotBeforeTheBootUp) {
  boot("cia402");
  drive().model().raise_fault(0x2310, {}, bus.now());
  EXPECT_EQ(next(), "081#1023030000000000");
  send("000#8101");
  drive().model().raise_fault(0x3210, {}, bus.now());
  EXPECT_EQ(next(1s), "701#00");
  EXPECT_EQ(next(1s), "");
}

TEST(EmergencyProducerTest, KeepsTheOrderAndTheTime) {
  EmergencyProducer producer;
  constexpr TimePoint kStart{1s};
  EXPECT_EQ(producer.deadline(10ms), kNever);
  producer.push(can::parse_frame("081#01").value());
  producer.push(can::parse_frame("081#02").value());
  EXPECT_EQ(can::to_string(producer.take_frame(10ms, kStart).value()), "081#01");
  EXPECT_EQ(producer.deadline(10ms), kStart + 10ms);
  EXPECT_FALSE(producer.take_frame(10ms, kStart + 9ms));
  EXPECT_EQ(can::to_string(producer.take_frame(10ms, kStart + 10ms).value()), "081#02");
  producer.push(can::parse_frame("081#03").value());
  producer.clear();
  EXPECT_EQ(producer.deadline(10ms), kNever);
}

}  // namespace
}  // namespace servoctl::sim
