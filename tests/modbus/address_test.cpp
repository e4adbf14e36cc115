#include "modbus/address.hpp"

#include <gtest/gtest.h>

namespace servoctl::modbus {
namespace {

TEST(ModbusAddress, ASerialLineHasSpeedAndFormOfCharacters) {
  const auto line = parse_serial("/dev/ttyUSB0@115200,8N1");
  ASSERT_TRUE(line);
  EXPECT_EQ(line->line.device, "/dev/ttyUSB0");
  EXPECT_EQ(line->text(), "115200,8N1");
  EXPECT_EQ(line->bits_per_character(), 10U);
}

TEST(ModbusAddress, WithoutASpeedItIsThatOfTheStandard) {
  EXPECT_EQ(parse_serial("/dev/ttyS0")->text(), "19200,8E1");
  EXPECT_EQ(parse_serial("/dev/ttyS0@9600")->text(), "9600,8E1");
  EXPECT_EQ(parse_serial("/dev/ttyS0")->bits_per_character(), 11U);
}

TEST(ModbusAddress, AsciiIsSaid) {
  const auto line = parse_serial("/dev/ttyS0@9600,7e1,ascii");
  ASSERT_TRUE(line);
  EXPECT_EQ(line->framing, Framing::ascii);
  EXPECT_EQ(line->text(), "9600,7E1,ascii");
}

TEST(ModbusAddress, WhatIsNoneIsRefused) {
  for (const auto* text : {"", "@9600", "/dev/x@", "/dev/x@fast", "/dev/x@0", "/dev/x@9600,8X1",
                           "/dev/x@9600,9N1", "/dev/x@9600,8N3", "/dev/x@9600,7E1", "/dev/x@9600,,"})
    EXPECT_FALSE(parse_serial(text)) << text;
  for (const auto* text : {"", ":502", "host:", "host:0", "host:65536", "host:x", "[::1", "[::1]x"})
    EXPECT_FALSE(parse_tcp(text)) << text;
}

TEST(ModbusAddress, AHostHasPort502UnlessItIsSaid) {
  EXPECT_EQ(parse_tcp("10.0.0.1")->text(), "10.0.0.1:502");
  EXPECT_EQ(parse_tcp("drive.local:1502")->port, 1502);
  EXPECT_EQ(parse_tcp("[::1]:1502")->text(), "[::1]:1502");
}

}  // namespace
}  // namespace servoctl::modbus
