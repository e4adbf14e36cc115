#include "drive/maker_parameters.hpp"

#include <gtest/gtest.h>

#include "drive/naming.hpp"

namespace servoctl::drive {
namespace {

std::string split_text(std::string_view name) {
  const auto split = split_number(name);
  return split ? split->id + "|" + split->name : std::string();
}

TEST(MakerParameters, TakeTheNumberOffANameHoweverItIsWritten) {
  EXPECT_EQ(split_text("Pr1.01 1st velocity loop gain"), "Pr1.01|1st velocity loop gain");
  EXPECT_EQ(split_text("P00-01:Control mode"), "P00-01|Control mode");
  EXPECT_EQ(split_text("P00-01：控制模式"), "P00-01|控制模式");
  EXPECT_EQ(split_text("Pn100速度环增益"), "Pn100|速度环增益");
  EXPECT_EQ(split_text("[C00.01] 控制模式"), "C00.01|控制模式");
  EXPECT_EQ(split_text("PA-21 Gain"), "PA-21|Gain");
  EXPECT_EQ(split_text("Pn20E - Ramp"), "Pn20E|Ramp");
  EXPECT_EQ(split_text("Pn100_1st gain"), "Pn100|1st gain");
}

TEST(MakerParameters, LeaveOtherNamesAsTheyAre) {
  for (const auto* name : {"DI1 function", "I2C address", "Motor temperature", "1.01 gain", "Gain", "Pr1.01",
                           "Parameter 12", "速度环增益1", "H", ""})
    EXPECT_EQ(split_text(name), "") << name;
}

od::Object variable(std::uint16_t index, std::string name) {
  od::Entry entry;
  entry.address = {index, 0};
  entry.name = name;
  entry.type = od::DataType::u16;
  return {index, std::move(name), od::ObjectCode::var, {entry}};
}

Profile maker_profile() {
  Profile out;
  out.family = "maker.eds";
  out.dictionary.add(variable(0x2101, "Pr1.01 1st velocity loop gain"));
  out.dictionary.add(variable(0x2106, "Pr1.06 2nd velocity loop gain"));
  out.dictionary.add(variable(0x2107, "Pr7.01 Input"));
  out.dictionary.add(variable(0x2108, "Pr7.1 Output"));
  out.dictionary.add(variable(0x2200, "速度环增益1"));
  out.dictionary.add(variable(0x2201, "速度环增益2"));
  out.dictionary.add(variable(0xA001, "A001 Other"));
  out.dictionary.add(variable(0x2300, "A001 Ramp"));
  out.dictionary.add(variable(0x6064, "Position actual value"));
  out.build_index();
  return out;
}

std::string place(std::string_view text, Match match = Match::whole) {
  const auto profile = maker_profile();
  const auto target = resolve(&profile, text, match);
  return target ? to_string(target->address)
                : target.error().message.text() + " / " + target.error().hint.text();
}

TEST(MakerParameters, AreTheManufacturersRangeAndNoNumberMeansTwo) {
  const auto profile = maker_profile();
  ASSERT_EQ(profile.parameters.size(), 7U);
  EXPECT_EQ(profile.parameter("pr1.1")->name, "1st velocity loop gain");
  EXPECT_EQ(profile.parameter("Pr7.01"), nullptr);  // Pr7.1 is the same number to whoever reads it.
  EXPECT_EQ(profile.parameter(ObjectAddress{0x2200, 0}), nullptr);
  EXPECT_EQ(resolve_parameter(profile, "0x2200").value()->name, "速度环增益1");
}

TEST(MakerParameters, AreWrittenByTheirNumberOrTheirWholeName) {
  for (const auto* text : {"Pr1.01", "pr1.1", "Pr1.01 1st velocity loop gain", "1ST VELOCITY LOOP GAIN"})
    EXPECT_EQ(place(text), "0x2101:0") << text;
  EXPECT_EQ(place("速度环增益1"), "0x2200:0");
  EXPECT_EQ(place("速度环 增益１"), "0x2200:0");
  EXPECT_NE(place("velocity loop gain").find("did you mean Pr1.01 1st velocity loop gain or Pr1.06"),
            std::string::npos);
  EXPECT_NE(place("速度环增益").find("did you mean 速度环增益1 or 速度环增益2?"), std::string::npos);
  EXPECT_NE(place("1").find("is not an object"), std::string::npos);
}

TEST(MakerParameters, AreReadByAPartThatNoOtherNameHas) {
  EXPECT_EQ(place("1st gain", Match::part), "0x2101:0");
  EXPECT_EQ(place("增益2", Match::part), "0x2201:0");
  EXPECT_NE(place("velocity gain", Match::part).find("ambiguous"), std::string::npos);
  EXPECT_NE(place("vleocity", Match::part).find("did you mean Pr1.01"), std::string::npos);
}

/// Another parameter than the one that was asked for must never be read.
TEST(MakerParameters, AreNotFoundByAPieceOfTheirNumber) {
  for (const auto* text : {"Pr1", "Pr1.0", "Pr01", "r1.01", "Pr1.011", "速度环增益"})
    EXPECT_EQ(place(text, Match::part).find("0x"), std::string::npos) << text;
  auto profile = maker_profile();
  profile.dictionary.add(variable(0x2202, "位置环增益10"));
  EXPECT_FALSE(resolve(&profile, "位置环增益1", Match::part));
  EXPECT_TRUE(resolve(&profile, "位置环", Match::part));
}

/// A number that reads as an index: where both exist neither is meant.
TEST(MakerParameters, AreNotTakenForAnotherObjectsIndex) {
  EXPECT_NE(place("A001").find("ambiguous"), std::string::npos);
  EXPECT_EQ(place("0xA001"), "0xA001:0");
}

}  // namespace
}  // namespace servoctl::drive
