#include "drive/cia402.hpp"
#include "drive/standard_mode.hpp"
#include "drive/word_bits.hpp"

#include <gtest/gtest.h>

#include <ios>

namespace servoctl::drive {
namespace {

constexpr DriveState kAll[] = {DriveState::not_ready_to_switch_on, DriveState::switch_on_disabled,
                               DriveState::ready_to_switch_on,     DriveState::switched_on,
                               DriveState::operation_enabled,      DriveState::quick_stop_active,
                               DriveState::fault_reaction_active,  DriveState::fault};

TEST(DriveState, IsDecodedFromEveryStatuswordByTheMasksOfTheProfile) {
  // CiA 402-2, table 30, written out bit by bit: x means any.
  const auto expected = [](unsigned w) {
    const bool b0 = w & 1, b1 = w & 2, b2 = w & 4, b3 = w & 8, b5 = w & 32, b6 = w & 64;
    if (!b6 && !b3 && !b2 && !b1 && !b0) return DriveState::not_ready_to_switch_on;
    if (b6 && !b3 && !b2 && !b1 && !b0) return DriveState::switch_on_disabled;
    if (!b6 && b5 && !b3 && !b2 && !b1 && b0) return DriveState::ready_to_switch_on;
    if (!b6 && b5 && !b3 && !b2 && b1 && b0) return DriveState::switched_on;
    if (!b6 && b5 && !b3 && b2 && b1 && b0) return DriveState::operation_enabled;
    if (!b6 && !b5 && !b3 && b2 && b1 && b0) return DriveState::quick_stop_active;
    if (!b6 && b3 && b2 && b1 && b0) return DriveState::fault_reaction_active;
    if (!b6 && b3 && !b2 && !b1 && !b0) return DriveState::fault;
    return DriveState::unknown;
  };
  for (unsigned word = 0; word <= 0xFFFF; ++word)
    ASSERT_EQ(decode_state(static_cast<std::uint16_t>(word)), expected(word)) << std::hex << word;
}

TEST(DriveState, OfStatuswordsPrintedInManualsIsFoundWhateverTheOtherBits) {
  EXPECT_EQ(decode_state(0x0270), DriveState::switch_on_disabled);
  EXPECT_EQ(decode_state(0x0250), DriveState::switch_on_disabled);
  EXPECT_EQ(decode_state(0x1231), DriveState::ready_to_switch_on);
  EXPECT_EQ(decode_state(0x9637), DriveState::operation_enabled);
  EXPECT_EQ(decode_state(0x0217), DriveState::quick_stop_active);
  EXPECT_EQ(decode_state(0x0088), DriveState::fault);
}

TEST(ControlCommand, IsDecodedByTheBitsOfTheProfile) {
  EXPECT_EQ(decode_command(0x06, 0), ControlCommand::shutdown);
  EXPECT_EQ(decode_command(0x0E, 0), ControlCommand::shutdown);
  EXPECT_EQ(decode_command(0x07, 0), ControlCommand::switch_on);
  EXPECT_EQ(decode_command(0x0F, 0), ControlCommand::enable_operation);
  EXPECT_EQ(decode_command(0x1F, 0), ControlCommand::enable_operation);
  EXPECT_EQ(decode_command(0x00, 0), ControlCommand::disable_voltage);
  EXPECT_EQ(decode_command(0x0D, 0), ControlCommand::disable_voltage);
  EXPECT_EQ(decode_command(0x02, 0), ControlCommand::quick_stop);
  EXPECT_EQ(decode_command(0x0B, 0), ControlCommand::quick_stop);
}

TEST(ControlCommand, OfAFaultResetIsTheRisingEdgeOfBitSevenOnly) {
  EXPECT_EQ(decode_command(0x80, 0x00), ControlCommand::fault_reset);
  EXPECT_EQ(decode_command(0x80, 0x80), ControlCommand::none);
  EXPECT_EQ(decode_command(0x8F, 0x80), ControlCommand::none);
  EXPECT_EQ(decode_command(0x0F, 0x80), ControlCommand::enable_operation);
}

TEST(NextState, FollowsEveryTransitionOfTheProfileAndNoOther) {
  struct Arrow {
    DriveState from;
    ControlCommand command;
    DriveState to;
  };
  using S = DriveState;
  using C = ControlCommand;
  const Arrow arrows[] = {
      {S::switch_on_disabled, C::shutdown, S::ready_to_switch_on},         // 2
      {S::ready_to_switch_on, C::switch_on, S::switched_on},               // 3
      {S::ready_to_switch_on, C::enable_operation, S::operation_enabled},  // 3 + 4
      {S::switched_on, C::enable_operation, S::operation_enabled},         // 4
      {S::operation_enabled, C::switch_on, S::switched_on},                // 5
      {S::switched_on, C::shutdown, S::ready_to_switch_on},                // 6
      {S::ready_to_switch_on, C::disable_voltage, S::switch_on_disabled},  // 7
      {S::ready_to_switch_on, C::quick_stop, S::switch_on_disabled},       // 7
      {S::operation_enabled, C::shutdown, S::ready_to_switch_on},          // 8
      {S::operation_enabled, C::disable_voltage, S::switch_on_disabled},   // 9
      {S::switched_on, C::disable_voltage, S::switch_on_disabled},         // 10
      {S::switched_on, C::quick_stop, S::switch_on_disabled},              // 10
      {S::operation_enabled, C::quick_stop, S::quick_stop_active},         // 11
      {S::quick_stop_active, C::disable_voltage, S::switch_on_disabled},   // 12
      {S::fault, C::fault_reset, S::switch_on_disabled},                   // 15
      {S::quick_stop_active, C::enable_operation, S::operation_enabled},   // 16
  };
  const C commands[] = {C::none,       C::shutdown,   C::switch_on, C::enable_operation, C::disable_voltage,
                        C::quick_stop, C::fault_reset};
  for (const auto from : kAll) {
    for (const auto command : commands) {
      auto expected = from;
      for (const auto& arrow : arrows)
        if (arrow.from == from && arrow.command == command) expected = arrow.to;
      EXPECT_EQ(next_state(from, command), expected) << name(from) << " " << static_cast<int>(command);
    }
  }
}

TEST(DriveState, ThatIsUnknownCountsAsEnergised) {
  for (const auto state : kAll) {
    const bool energised = state == DriveState::operation_enabled || state == DriveState::quick_stop_active ||
                           state == DriveState::fault_reaction_active;
    EXPECT_EQ(is_energised(state), energised) << name(state);
    EXPECT_FALSE(name(state).empty());
    EXPECT_FALSE(name_zh(state).empty());
  }
  EXPECT_TRUE(is_energised(DriveState::unknown));
}

TEST(StatuswordBits, AreNamedByModeWhereTheirMeaningDependsOnIt) {
  EXPECT_EQ(
      statusword_bits(0x1637, 1),
      (std::vector<std::string>{"voltage enabled", "remote", "target reached", "set-point acknowledge"}));
  EXPECT_EQ(statusword_bits(0x1231, 3),
            (std::vector<std::string>{"voltage enabled", "remote", "speed is zero"}));
  EXPECT_EQ(statusword_bits(0x2000, 6), (std::vector<std::string>{"homing error"}));
  EXPECT_EQ(statusword_bits(0x0000, 1), std::vector<std::string>{});
  const auto by_mode = [](std::int8_t mode) { return statusword_bits(0x3400, mode); };
  EXPECT_EQ(by_mode(4), (std::vector<std::string>{"target reached", "bit 12", "bit 13"}));
  EXPECT_EQ(by_mode(7), (std::vector<std::string>{"target reached", "ip mode active", "bit 13"}));
  EXPECT_EQ(by_mode(8),
            (std::vector<std::string>{"bit 10", "drive follows command value", "following error"}));
  EXPECT_EQ(by_mode(9), (std::vector<std::string>{"bit 10", "drive follows command value", "bit 13"}));
  EXPECT_EQ(by_mode(10), by_mode(9));
}

TEST(WordsOfControlAndStatus, TellStateOrCommandAndTheBitsBeside) {
  EXPECT_EQ(statusword_words(0x1637, 1),
            "operation enabled (voltage enabled, remote, target reached, set-point acknowledge)");
  EXPECT_EQ(statusword_words(0x0040, 0), "switch on disabled");
  const Chinese upper = [](std::string_view word) -> std::string_view {
    return word == "bit {}" ? "BIT {}" : word == "bit 12" ? "BIT 12" : word == "halt" ? "HALT" : "OTHER";
  };
  EXPECT_EQ(statusword_words(0x1227, 0, upper),
            std::string(name_zh(DriveState::operation_enabled)) + "（OTHER，BIT 12）");
  EXPECT_EQ(controlword_words(0x012F, 0, upper), "OTHER（BIT 5，HALT）");
  EXPECT_EQ(controlword_words(0x0006, 1), "shutdown");
  EXPECT_EQ(controlword_words(0x027F, 1),
            "enable operation (new set-point, change set immediately, relative, change on set-point)");
  EXPECT_EQ(controlword_words(0x007F, 2), "enable operation (enable ramp, unlock ramp, reference ramp)");
  EXPECT_EQ(controlword_words(0x011F, 6), "enable operation (homing operation start, halt)");
  EXPECT_EQ(controlword_words(0x001F, 7), "enable operation (enable interpolation)");
  for (const int mode : {0, 3, 4, 8, 9, 10})
    EXPECT_EQ(controlword_words(0x003F, static_cast<std::int8_t>(mode)), "enable operation (bit 4, bit 5)")
        << mode;
  EXPECT_EQ(controlword_words(0x8080, 0), "fault reset (bit 15)");
  EXPECT_EQ(controlword_words(0x0002, 1), "quick stop");
}

TEST(DeviceKind, IsWhatTheDriveAnnounces) {
  EXPECT_EQ(device_kind(0x00020192), "CiA 402, servo drive");
  EXPECT_EQ(device_kind(0x00060192), "CiA 402, servo drive and stepper motor");
  EXPECT_EQ(device_kind(0x00000192), "CiA 402, kind of drive not stated");
  EXPECT_EQ(device_kind(0xFFFF0192), "CiA 402, several devices");
}

TEST(StandardMode, IsWhatTheFamilyMeansByTheNumber) {
  MotionRules standard;
  standard.position = 1;
  standard.velocity = 3;
  EXPECT_EQ(standard_mode(standard, 3), 3);
  EXPECT_EQ(standard_mode(standard, 8), 8);
  MotionRules own;
  own.position = 2;
  own.velocity = 4;
  own.torque = 6;
  EXPECT_EQ(standard_mode(own, 2), 1);
  EXPECT_EQ(standard_mode(own, 4), 3);
  EXPECT_EQ(standard_mode(own, 6), 4);
  for (const int mode : {1, 3, 5, 8})
    EXPECT_EQ(standard_mode(own, static_cast<std::int8_t>(mode)), 0) << mode;
  own.handshake = false;
  EXPECT_EQ(standard_mode(own, 2), 0);
  EXPECT_EQ(standard_mode(MotionRules{}, 6), 6);
}

}  // namespace
}  // namespace servoctl::drive
