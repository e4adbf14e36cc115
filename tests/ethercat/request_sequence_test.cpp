#include "ethercat/request_sequence.hpp"

#include <gtest/gtest.h>

#include "ethercat/registers.hpp"
#include "ethercat/slave_plan.hpp"
#include "hex.hpp"

namespace servoctl::ethercat {
namespace {

constexpr auto kSlave = SlaveAddress::station(0x1001);
constexpr TimePoint kNow{std::chrono::seconds(1)};

TEST(RequestSequence, MakesOneRequestAfterAnother) {
  RequestSequence sequence(1);
  sequence.start(
      {read_registers(kSlave, reg::kStationAlias, 2), write_registers(kSlave, reg::kAlControl, {1, 0})});
  EXPECT_EQ(sequence.take_request()->address, kSlave.at(reg::kStationAlias));
  EXPECT_FALSE(sequence.take_request()) << "while one is under way";
  sequence.on_answer({hex("0500"), 1, false, kNow}, kNow);
  EXPECT_FALSE(sequence.take_result());
  EXPECT_EQ(sequence.take_request()->address, kSlave.at(reg::kAlControl));
  sequence.on_answer({hex("0100"), 1, false, kNow}, kNow);
  EXPECT_FALSE(sequence.busy());
  const auto result = sequence.take_result();
  ASSERT_TRUE(result && *result);
  EXPECT_EQ(**result, (std::vector<Bytes>{hex("0500"), hex("0100")}));
  EXPECT_FALSE(sequence.take_request());
}

TEST(RequestSequence, TheFirstThatIsNotDoneEndsItAndIsNamed) {
  RequestSequence sequence(3);
  const auto ends = [&](const Answer& answer) {
    sequence.start(
        {write_registers(kSlave, reg::sync_manager(2), Bytes(8)), read_registers(kSlave, 0x0130, 6)});
    (void)sequence.take_request();
    sequence.on_answer(answer, kNow);
    EXPECT_FALSE(sequence.busy());
    EXPECT_FALSE(sequence.take_request());
    const auto result = sequence.take_result();
    EXPECT_TRUE(result && !*result);
    return result ? result->error() : Error{};
  };
  EXPECT_EQ(ends({{}, 0, false, kNow}).message,
            "node 3: register 0810h cannot be written: it does not answer");
  const auto lost = ends({{}, 0, true, kNow});
  EXPECT_EQ(lost.message.text(), "node 3: register 0810h cannot be written: frames do not come back");
  EXPECT_EQ(lost.code, Errc::timeout);
  EXPECT_EQ(lost.node, 3);
}

TEST(RequestSequence, OneOfNothingIsDoneAtOnce) {
  RequestSequence sequence(3);
  sequence.start({});
  EXPECT_FALSE(sequence.busy());
  EXPECT_FALSE(sequence.take_request());
  EXPECT_TRUE(sequence.take_result());
}

TEST(RequestSequence, DefaultsGoToAllSlavesAndARegisterThatNoneHasIsNoError) {
  RequestSequence sequence(0);
  sequence.start(default_settings());
  std::vector<std::string> seen;
  while (const auto request = sequence.take_request()) {
    EXPECT_EQ(request->command, Command::bwr);
    EXPECT_EQ(request->address & 0xFFFF, 0U);
    seen.push_back(to_hex(store_le(request->address >> 16, 2), "") + " " +
                   std::to_string(request->data.size()));
    sequence.on_answer({request->data, 0, false, kNow}, kNow);
  }
  EXPECT_TRUE(*sequence.take_result());
  // As masters do it (SOEM, ec_config.c): alias, loops, counters, FMMUs, sync managers, SYNC, clock, SII.
  EXPECT_EQ(seen, (std::vector<std::string>{"0301 1", "0101 1", "0003 8", "0006 48", "0008 32", "8109 1",
                                            "1009 4", "3009 2", "3409 2", "0005 1", "0005 1"}));
  sequence.start(default_settings());
  (void)sequence.take_request();
  sequence.on_answer({{}, 0, true, kNow}, kNow);
  EXPECT_EQ(sequence.take_result()->error().code, Errc::bus);
}

TEST(RequestSequence, AStationAddressIsGivenByPosition) {
  const auto requests = station_setup(2, 0x1003);
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].command, Command::apwr);
  EXPECT_EQ(requests[0].address, physical_address(0xFFFE, reg::kStationAddress));
  EXPECT_EQ(to_hex(requests[0].data), "03 10");
}

}  // namespace
}  // namespace servoctl::ethercat
