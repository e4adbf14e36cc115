#include "sim/modbus_unit.hpp"

#include <gtest/gtest.h>

#include "sim/modbus_cell.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::sim {
namespace {

constexpr TimePoint kPowerOn{std::chrono::seconds(1)};

class ModbusUnitTest : public testing::Test {
 protected:
  void SetUp() override {
    auto built = build_modbus_cell("ts@3", folders, kPowerOn);
    ASSERT_TRUE(built) << built.error().message.text();
    cell = std::move(*built);
  }
  std::string ask(std::string_view pdu, std::uint8_t unit = 3) {
    const auto answer =
        cell.on_message(modbus::Framing::rtu, {unit, 0, parse_hex_bytes(pdu).value()}, kPowerOn);
    if (!answer) return "";
    return to_hex(ByteSpan(answer->bytes).subspan(1, answer->bytes.size() - 3));
  }

  const std::vector<std::filesystem::path> folders{std::filesystem::path(source_dir()) / "eds"};
  ModbusCell cell;
};

TEST_F(ModbusUnitTest, AnswersItsAddressAlone) {
  EXPECT_EQ(ask("03 00 00 00 01"), "03 02 00 02");
  EXPECT_EQ(ask("03 00 00 00 01", 4), "");
}

TEST_F(ModbusUnitTest, ItsAddressStandsInItsParameter) { EXPECT_EQ(ask("03 00 3A 00 01"), "03 02 00 03"); }

TEST_F(ModbusUnitTest, TakesWhatIsWritten) {
  EXPECT_EQ(ask("06 00 33 00 C8"), "06 00 33 00 C8");
  EXPECT_EQ(ask("03 00 33 00 01"), "03 02 00 C8");
  EXPECT_EQ(ask("10 00 30 00 02 04 00 05 00 06"), "10 00 30 00 02");
  EXPECT_EQ(ask("03 00 30 00 02"), "03 04 00 05 00 06");
}

TEST_F(ModbusUnitTest, AMessageToAllIsObeyedAndNotAnswered) {
  EXPECT_EQ(ask("06 00 33 00 64", 0), "");
  EXPECT_EQ(ask("03 00 33 00 01"), "03 02 00 64");
}

TEST_F(ModbusUnitTest, RefusesByTheExceptionsOfTheStandard) {
  EXPECT_EQ(ask("03 05 00 00 01"), "83 02");  // No such register.
  EXPECT_EQ(ask("06 10 00 00 01"), "86 02");  // Dn_00 is read-only.
  EXPECT_EQ(ask("06 00 99 00 02"), "86 03");  // Fn_99 is 0 or 1.
  EXPECT_EQ(ask("03 00 33 00 00"), "83 03");  // No register at all.
  EXPECT_EQ(ask("2B 0E 01 00 00"), "AB 01");  // No such function.
}

TEST_F(ModbusUnitTest, HasAsManyInputsAndOutputsAsTheManualSays) {
  EXPECT_EQ(ask("02 00 00 00 08"), "02 01 00");
  EXPECT_EQ(ask("01 00 00 00 04"), "01 01 00");
  EXPECT_EQ(ask("02 00 00 00 09"), "82 02");
}

TEST_F(ModbusUnitTest, AnswersToMalformedRequestsAreRefusals) {
  for (const auto* pdu :
       {"03", "03 00", "06 00 33", "10 00 30 00 02 04 00 05", "10 00 30 00 00 00", "00 00 00 00 00"})
    EXPECT_EQ(ask(pdu).substr(0, 1), pdu[0] == '1' ? "9" : "8") << pdu;
}

TEST(ModbusCellTest, RefusesWhatHasNoRegisters) {
  const std::vector<std::filesystem::path> folders{std::filesystem::path(source_dir()) / "eds"};
  EXPECT_FALSE(build_modbus_cell("gsd600@1", folders, kPowerOn));
  EXPECT_FALSE(build_modbus_cell("ts@1,ts@1", folders, kPowerOn));
  EXPECT_FALSE(build_modbus_cell("ts@1?wobble=3", folders, kPowerOn));
}

TEST(ModbusCellTest, DamagesEveryNthAnswer) {
  const std::vector<std::filesystem::path> folders{std::filesystem::path(source_dir()) / "eds"};
  auto cell = build_modbus_cell("ts@1?damage=2", folders, kPowerOn);
  ASSERT_TRUE(cell);
  unsigned bad = 0;
  for (int i = 0; i < 10; ++i) {
    const auto answer = cell->on_message(modbus::Framing::rtu, {1, 0, {3, 0, 0, 0, 1}}, kPowerOn);
    ASSERT_TRUE(answer);
    modbus::Deframer in(modbus::Framing::rtu, modbus::Deframer::Expects::answers);
    in.push(answer->bytes);
    if (!in.take()) ++bad;
  }
  EXPECT_EQ(bad, 5U);
}

}  // namespace
}  // namespace servoctl::sim
