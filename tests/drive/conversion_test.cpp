// Conversions between raw values and units are exact both ways or refused, for every entry of every family.
#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include <fmt/format.h>
#include <cmath>

#include "drive/quantity.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::drive {
namespace {

/// Everything of a family that has a unit, a scale or an encoding.
const std::vector<Target>& measured_targets() {
  static std::vector<Profile> profiles;
  static const std::vector<Target> kTargets = [] {
    std::vector<Target> out;
    for (const auto& family : find_families(kFolders))
      profiles.push_back(load_profile(family.name, kFolders).value());
    for (const auto& profile : profiles) {
      for (const auto& object : profile.dictionary.objects())
        for (const auto& entry : object.entries) out.push_back(target_at(&profile, entry.address));
      for (const auto& parameter : profile.parameters) out.push_back({{}, nullptr, &parameter, {}, false});
    }
    std::erase_if(out, [](const Target& target) {
      const auto m = meaning(target, 1);
      return m.unit.empty() || !od::is_integer(m.type);
    });
    return out;
  }();
  return kTargets;
}

/// Any raw value of the type that its limits allow.
od::Value any_value(const Meaning& m) {
  const auto bits = *rc::gen::arbitrary<std::uint64_t>();
  const auto size = od::size_of(m.type).value();
  const auto value = od::decode(m.type, store_le(bits, size)).value();
  RC_PRE(check_limits(m, value).has_value());
  return value;
}

TEST(Conversions, CoverAllFamilies) { EXPECT_GT(measured_targets().size(), 500U); }

RC_GTEST_PROP(Conversions, OfTheOwnUnitComeBackExactly, ()) {
  const auto m = meaning(*rc::gen::elementOf(measured_targets()), 1);
  const auto value = any_value(m);
  // Nearer to 0 a float has not the digits that a value is shown with.
  if (m.encoding != od::Encoding::plain) {
    const auto number = od::decode_number(m.encoding, value);
    RC_PRE(number == 0 || std::isnormal(static_cast<float>(number)));
  }
  const auto text = fmt::format("{:.17g}{}", scaled(m, value), m.unit);
  const auto back = parse_quantity(m, text);
  RC_LOG() << text << (back ? "" : ": " + back.error().message.text());
  RC_ASSERT(back.has_value());
  RC_ASSERT(scaled(m, *back) == scaled(m, value));
  if (m.encoding == od::Encoding::plain) RC_ASSERT(od::compare_numbers(*back, value) == 0);
}

RC_GTEST_PROP(Conversions, ByTheDrivesGearComeBackExactly, ()) {
  const auto target = *rc::gen::elementOf(measured_targets());
  auto m = meaning(target, 1);
  RC_PRE(m.measure.has_value());
  const auto measure = *rc::gen::inRange(1, 1 << 24);
  m.bridge = bridge(m.unit, target.address, measure);
  RC_ASSERT(m.bridge.has_value());
  const auto value = any_value(m);
  const auto shown = familiar(m, value);
  RC_ASSERT(shown.has_value());
  const auto back = parse_quantity(m, fmt::format("{:.14g}{}", shown->value, shown->unit));
  RC_LOG() << fmt::format("{} {:.14g}{}: {}", m.unit, shown->value, shown->unit,
                          back ? "" : back.error().message.text());
  RC_ASSERT(back.has_value());
  RC_ASSERT(od::compare_numbers(*back, value) == 0);
}

RC_GTEST_PROP(Conversions, BetweenStepsAreRefused, ()) {
  auto m = meaning(*rc::gen::elementOf(measured_targets()), 1);
  RC_PRE(m.encoding == od::Encoding::plain);
  const auto step = *rc::gen::inRange(1, 100);
  const auto text = fmt::format("{:.17g}{}", (step + 0.5) * m.scale, m.unit);
  m.min.reset();
  m.max.reset();
  RC_ASSERT(!parse_quantity(m, text).has_value());
}

TEST(Conversions, OfFloatsInHalvesDropTheLowerBits) {
  Meaning m;
  m.type = od::DataType::u16;
  m.type_known = true;
  m.encoding = od::Encoding::f32hi;
  m.unit = "rad/s";
  // The manual's own defaults (35, 217): 0.1, 0.01 and 0.2 as halves.
  EXPECT_EQ(parse_quantity(m, "0.1").value(), od::Value(std::uint64_t{0x3DCC}));
  EXPECT_EQ(parse_quantity(m, "0.01").value(), od::Value(std::uint64_t{0x3C23}));
  EXPECT_EQ(parse_quantity(m, "0.2").value(), od::Value(std::uint64_t{0x3E4C}));
  EXPECT_NEAR(scaled(m, od::Value(std::uint64_t{0x3DCC})), 0.1, 0.001);
  EXPECT_EQ(parse_quantity(m, "0x3F80").value(), od::Value(std::uint64_t{0x3F80}));
  EXPECT_FALSE(parse_quantity(m, "1e39"));
}

TEST(Conversions, TakeHenryForAUnitWhereTheObjectHasIt) {
  Meaning m;
  m.type = od::DataType::u32;
  m.type_known = true;
  m.unit = "H";
  m.encoding = od::Encoding::f32;
  EXPECT_EQ(scaled(m, parse_quantity(m, "10H").value()), 10);
  EXPECT_EQ(parse_quantity(m, "0x3F800000").value(), od::Value(std::uint64_t{0x3F80'0000}));
  m.unit = "A";
  m.encoding = od::Encoding::plain;
  EXPECT_EQ(parse_quantity(m, "10h").value(), od::Value(std::uint64_t{16}));
}

TEST(Conversions, OfFloatsCompareNumbersAndNotBitPatterns) {
  Meaning m;
  m.type = od::DataType::i32;
  m.type_known = true;
  m.encoding = od::Encoding::f32;
  m.min = parse_quantity(m, "-2.5").value();
  m.max = parse_quantity(m, "-0.5").value();
  EXPECT_TRUE(parse_quantity(m, "-1"));
  EXPECT_FALSE(parse_quantity(m, "-3"));
  EXPECT_FALSE(parse_quantity(m, "0"));
  EXPECT_EQ(range_text(m), "-2.5..-0.5");
}

TEST(Conversions, TakeTheLengthTheDriveHas) {
  Meaning m;
  m.type = od::DataType::i16;
  m.type_known = true;
  m.size_known = false;
  EXPECT_EQ(fitted(m, 4).type, od::DataType::i32);
  EXPECT_EQ(fitted(m, 3).type, od::DataType::i16);
  m.type = od::DataType::u32;
  m.encoding = od::Encoding::f32;
  EXPECT_EQ(fitted(m, 2).encoding, od::Encoding::f32hi);
  EXPECT_EQ(fitted(m, 2).type, od::DataType::u16);
  m.size_known = true;
  EXPECT_EQ(fitted(m, 2).type, od::DataType::u32);
}

}  // namespace
}  // namespace servoctl::drive
