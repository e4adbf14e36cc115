#include "drive/quantity.hpp"

#include <gtest/gtest.h>

#include "drive/naming.hpp"

namespace servoctl::drive {
namespace {

Meaning hertz() {
  Meaning m;
  m.type = od::DataType::u16;
  m.type_known = true;
  m.unit = "Hz";
  m.scale = 0.1;
  m.min = od::Value(std::uint64_t{1});
  m.max = od::Value(std::uint64_t{20000});
  return m;
}

Meaning rpm() {
  Meaning m = hertz();
  m.type = od::DataType::i16;
  m.unit = "rpm";
  m.scale = 1;
  m.min = od::Value(std::int64_t{-3000});
  m.max = od::Value(std::int64_t{3000});
  return m;
}

std::uint64_t unsigned_of(const Result<od::Value>& value) {
  EXPECT_TRUE(value) << (value ? "" : value.error().message.text());
  return value ? std::get<std::uint64_t>(*value) : 0;
}

std::int64_t signed_of(const Result<od::Value>& value) {
  EXPECT_TRUE(value) << (value ? "" : value.error().message.text());
  return value ? std::get<std::int64_t>(*value) : 0;
}

void expect_refused(const Meaning& meaning, std::string_view text, std::string_view message,
                    std::string_view hint) {
  const auto value = parse_quantity(meaning, text);
  ASSERT_FALSE(value) << text;
  EXPECT_EQ(value.error().code, Errc::usage);
  EXPECT_EQ(value.error().message.text(), message);
  EXPECT_EQ(value.error().hint.text(), hint);
}

TEST(Quantity, OfAPlainNumberIsTheRawNumberOfThePanel) {
  EXPECT_EQ(unsigned_of(parse_quantity(hertz(), "400")), 400U);
  EXPECT_EQ(unsigned_of(parse_quantity(hertz(), "0x64")), 100U);
  EXPECT_EQ(unsigned_of(parse_quantity(hertz(), "64h")), 100U);
  EXPECT_EQ(unsigned_of(parse_quantity(hertz(), " 010 ")), 10U);
  EXPECT_EQ(signed_of(parse_quantity(rpm(), "-5")), -5);
}

TEST(Quantity, WithAUnitIsConvertedExactly) {
  EXPECT_EQ(unsigned_of(parse_quantity(hertz(), "40Hz")), 400U);
  EXPECT_EQ(unsigned_of(parse_quantity(hertz(), "40.1 Hz")), 401U);
  EXPECT_EQ(unsigned_of(parse_quantity(hertz(), "0.5kHz")), 5000U);
  EXPECT_EQ(signed_of(parse_quantity(rpm(), "1.5rev/s")), 90);
  EXPECT_EQ(signed_of(parse_quantity(rpm(), "-360deg/s")), -60);
  EXPECT_EQ(signed_of(parse_quantity(rpm(), "60RPM")), 60);
}

TEST(Quantity, ThatDoesNotComeOutExactIsRefusedWithTheNearest) {
  expect_refused(hertz(), "40.05Hz", "'40.05Hz' is 400.5 steps of 0.1 Hz, not a whole number",
                 "the nearest value is 40 Hz");
  expect_refused(hertz(), "0.04Hz", "'0.04Hz' is 0.4 steps of 0.1 Hz, not a whole number",
                 "the nearest value is 0.1 Hz");
  expect_refused(hertz(), "2500.04Hz", "'2500.04Hz' is 25000.4 steps of 0.1 Hz, not a whole number",
                 "the nearest value is 2000 Hz");
}

TEST(Quantity, InAForeignUnitIsRefused) {
  expect_refused(hertz(), "45rpm", "'45rpm': the unit of this object is Hz; rpm cannot be converted to it",
                 "write a value in Hz or the raw number");
  auto plain = hertz();
  plain.unit = "";
  expect_refused(plain, "45Hz", "'45Hz' carries a unit, but this object has none", "write the plain number");
}

TEST(Quantity, OutOfRangeIsRefusedBeforeTheBus) {
  expect_refused(hertz(), "0", "0 is out of range: 1..20000 = 0.1..2000 Hz", "one step is 0.1 Hz");
  expect_refused(hertz(), "99999Hz", "99999Hz is out of range: 1..20000 = 0.1..2000 Hz", "");
  expect_refused(hertz(), "99999", "99999 is out of range: 1..20000 = 0.1..2000 Hz", "");
  expect_refused(rpm(), "3001", "3001 is out of range: -3000..3000", "");
  EXPECT_EQ(unsigned_of(parse_quantity(hertz(), "1")), 1U);
  EXPECT_EQ(unsigned_of(parse_quantity(hertz(), "20000")), 20000U);
}

TEST(Quantity, ThatIsNeitherNothingNorEnoughIsRefused) {
  Meaning period;
  period.type = od::DataType::u32;
  period.type_known = true;
  period.least = 1000;
  EXPECT_EQ(unsigned_of(parse_quantity(period, "0")), 0U);
  EXPECT_EQ(unsigned_of(parse_quantity(period, "1000")), 1000U);
  for (const auto* text : {"1", "999"})
    expect_refused(period, text, std::string(text) + " is out of range: 0, or at least 1000",
                   "0 switches it off");
  period.least_assumed = true;
  expect_refused(period, "1", "1 is out of range: 0, or at least 1000",
                 "0 switches it off; the minimum 1000 is assumed: the manual may mean the step size");
  period.max = od::Value(std::uint64_t{5000});
  EXPECT_EQ(range_text(period), "0, or 1000..5000");
  expect_refused(period, "5001", "5001 is out of range: 0, or 1000..5000", "");
}

Meaning labelled(const std::vector<od::EnumLabel>& labels) {
  auto mode = hertz();
  mode.unit = "";
  mode.scale = 1;
  mode.min.reset();
  mode.labels = &labels;
  return mode;
}

TEST(Quantity, MayBeALabelInEitherLanguage) {
  const std::vector<od::EnumLabel> labels{{0, "Position mode", "位置模式"}, {8, "CANopen", ""}};
  const auto mode = labelled(labels);
  EXPECT_EQ(unsigned_of(parse_quantity(mode, "canopen")), 8U);
  EXPECT_EQ(unsigned_of(parse_quantity(mode, "位置模式")), 0U);
  expect_refused(mode, "speed", "'speed' is not a value of this object",
                 "values: 0 Position mode, 8 CANopen");
  ASSERT_NE(label_of(mode, od::Value(std::uint64_t{8})), nullptr);
  EXPECT_EQ(label_of(mode, od::Value(std::uint64_t{1})), nullptr);
}

TEST(Quantity, MayBeWhatStandsInTheBracketOfALabel) {
  const std::vector<od::EnumLabel> labels{{3, "Profile velocity (pv)", "轮廓速度模式 (pv)"},
                                          {4, "Torque (tq)", ""},
                                          {5, "Torque (held)", ""},
                                          {6, "Step (3)", ""}};
  const auto mode = labelled(labels);
  EXPECT_EQ(unsigned_of(parse_quantity(mode, "PV")), 3U);
  EXPECT_EQ(unsigned_of(parse_quantity(mode, "profile velocity")), 3U);
  EXPECT_EQ(unsigned_of(parse_quantity(mode, "tq")), 4U);
  EXPECT_EQ(unsigned_of(parse_quantity(mode, "held")), 5U);
  EXPECT_EQ(unsigned_of(parse_quantity(mode, "3")), 3U) << "a number is the value";
  EXPECT_FALSE(parse_quantity(mode, "torque")) << "two are called so";
}

TEST(Scaled, HasNoNoiseOfBinaryFractions) {
  auto m = hertz();
  for (std::uint64_t raw = 0; raw < 20000; raw += 7) {
    const auto text = std::to_string(raw / 10) + "." + std::to_string(raw % 10);
    EXPECT_EQ(scaled(m, od::Value(raw)), std::stod(text)) << raw;
  }
}

TEST(Quantity, OfEveryStepGoesToUnitsAndBack) {
  const auto m = hertz();
  for (std::uint64_t raw = 1; raw <= 20000; raw += 3) {
    const auto text = std::to_string(scaled(m, od::Value(raw))) + "Hz";
    ASSERT_EQ(unsigned_of(parse_quantity(m, text)), raw) << text;
  }
}

TEST(RangeText, LeavesOutWhatIsNotKnown) {
  auto m = hertz();
  EXPECT_EQ(range_text(m), "1..20000");
  m.min.reset();
  EXPECT_EQ(range_text(m), "at most 20000");
  m.max.reset();
  EXPECT_EQ(range_text(m), "");
}

TEST(Quantity, OfBitsIsToldInHexadecimal) {
  const auto text = [](ObjectAddress object, std::uint64_t value) {
    return plain_text(meaning(target_at(nullptr, object), 1), od::Value(value));
  };
  EXPECT_EQ(text({0x60FD, 0}, 4128772), "0x003F0004");
  EXPECT_EQ(text({0x60FE, 1}, 0x10000), "0x00010000");
  EXPECT_EQ(text({0x6041, 0}, 0x270), "0x0270");
  EXPECT_EQ(text({0x60FE, 0}, 2), "2");
  auto inputs = meaning(target_at(nullptr, {0x60FD, 0}), 1);
  inputs.type = od::DataType::u32;
  inputs.type_known = true;
  EXPECT_EQ(plain_text(inputs, od::Value(std::uint64_t{1})), "0x00000001");
}

TEST(Quantity, IsToldWithoutAnExponent) {
  Meaning m = hertz();
  m.encoding = od::Encoding::f32;
  EXPECT_EQ(plain_text(m, od::Value(std::uint64_t{0x551184E7})), "1000000000000");
}

TEST(QuantityOfBits, OfInfinityOrOfNoNumberIsRefused) {
  Meaning encoded;
  encoded.type_known = true;
  encoded.encoding = od::Encoding::f32;
  EXPECT_FALSE(parse_quantity(encoded, "0x7FC00000")) << "NaN";
  EXPECT_FALSE(parse_quantity(encoded, "0xFF800000")) << "-infinity";
  EXPECT_TRUE(parse_quantity(encoded, "0x7F7FFFFF")) << "the greatest finite number";
  Meaning real;
  real.type = od::DataType::f32;
  real.type_known = true;
  EXPECT_FALSE(check_limits(real, *od::decode(od::DataType::f32, store_le(0x7FC00000, 4))));
  EXPECT_TRUE(check_limits(real, od::Value(1.5)));
}

}  // namespace
}  // namespace servoctl::drive
