#include "drive/rules.hpp"

#include <gtest/gtest.h>

#include "drive/enabling_write.hpp"
#include "drive/naming.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::drive {
namespace {

TEST(Rules, AreReadWhole) {
  const auto rules = parse_rules(R"(
format = 1
family = "x1"
vendor = "Example"
name = "X1"
[identity]
certain = true
match = [{ object = "0x1000:00", value = 0x20192 }, { object = "0x1018:01", value = 7 }]
[[numbering]]
prefix = "A"
index = 0x2000
block = 200
first_sub = 1
[sdo]
segmented = false
[statusword]
fault = 0x0238
mode_bits = [{ mode = -3, disabled = 0x1000 }]
[quick_stop]
stays_enabled = [5, 6]
[fault]
reset_enabled_by = { object = "0x2000:21", value = 1 }
[abort_codes]
0x08000024 = "数值不存在"
)",
                                 "x1.toml");
  ASSERT_TRUE(rules) << rules.error().message.text();
  EXPECT_EQ(rules->family, "x1");
  ASSERT_EQ(rules->identity.size(), 2U);
  EXPECT_EQ(rules->identity[1].object, (ObjectAddress{0x1018, 1}));
  EXPECT_EQ(rules->identity[1].value, 7U);
  EXPECT_TRUE(rules->identity_certain);
  ASSERT_EQ(rules->numbering.size(), 1U);
  EXPECT_EQ(rules->numbering[0].block, 200U);
  EXPECT_FALSE(rules->sdo.segmented);
  EXPECT_TRUE(rules->sdo.exact_length);
  EXPECT_EQ(rules->statusword[static_cast<std::size_t>(DriveState::fault)], 0x0238);
  ASSERT_EQ(rules->mode_bits.size(), 1U);
  EXPECT_EQ(rules->mode_bits[0].mode, -3);
  EXPECT_EQ(rules->quick_stop_stays_enabled, (std::vector<std::int64_t>{5, 6}));
  ASSERT_TRUE(rules->fault.reset_enabled_by);
  EXPECT_EQ(rules->fault.reset_enabled_by->object, (ObjectAddress{0x2000, 0x21}));
  EXPECT_EQ(rules->abort_texts.at(0x0800'0024).text_zh, "数值不存在");
}

TEST(Rules, KnowWhereTheMailboxesOfAnEthercatSlaveAre) {
  const std::string head = "format = 1\nfamily = \"x1\"\n[coe]\n";
  const auto rules = parse_rules(head + R"(
mailbox_out = [0x1000, 256]
mailbox_in = [0x1400, 128]
outputs = 0x1800
inputs = 0x1C00
sdo_info = true
)",
                                 "x1.toml");
  ASSERT_TRUE(rules) << rules.error().message.text();
  EXPECT_TRUE(rules->coe.exists());
  EXPECT_EQ(rules->coe.mailbox_in.start, 0x1400);
  EXPECT_EQ(rules->coe.mailbox_in.size, 128);
  EXPECT_EQ(rules->coe.inputs, 0x1C00);
  EXPECT_TRUE(rules->coe.sdo_info);
  EXPECT_FALSE(rules->coe.complete_access);
  EXPECT_FALSE(parse_rules("format = 1\nfamily = \"x1\"\n", "x1.toml")->coe.exists());
  for (const auto* wrong : {"[0x1000]", "[0x1000, 1, 2]", "[0xFFFF, 2]", "0x1000"})
    EXPECT_FALSE(parse_rules(head + "mailbox_out = " + wrong + "\n", "x1.toml")) << wrong;
}

TEST(Rules, RegistersOfModbusAreBlocksOfObjects) {
  const std::string head = "format = 1\nfamily = \"x1\"\n[modbus]\n";
  const auto rules = parse_rules(
      head +
          "registers = [{ index = 0x2000, count = 0x300, at = 0 }, { index = 0x3000, count = 0x30, at = 0x1000 }]",
      "x1.toml");
  ASSERT_TRUE(rules) << rules.error().message.text();
  const auto& modbus = rules->modbus;
  EXPECT_EQ(modbus.register_of({0x2000, 0}), 0);
  EXPECT_EQ(modbus.register_of({0x22FF, 0}), 0x02FF);
  EXPECT_EQ(modbus.register_of({0x2300, 0}), std::nullopt);
  EXPECT_EQ(modbus.register_of({0x2000, 1}), std::nullopt);
  EXPECT_EQ(modbus.register_of({0x302F, 0}), 0x102F);
  EXPECT_EQ(modbus.register_of({0x3030, 0}), std::nullopt);
  EXPECT_EQ(modbus.register_of({0x1FFF, 0}), std::nullopt);
  EXPECT_EQ(modbus.object_at(0x02FF), (ObjectAddress{0x22FF, 0}));
  EXPECT_EQ(modbus.object_at(0x0300), std::nullopt);
  EXPECT_EQ(modbus.object_at(0x1000), (ObjectAddress{0x3000, 0}));
  for (const auto* bad :
       {"registers = [{ index = 0x2000, count = 0, at = 0 }]", "registers = [{ index = 0x2000, count = 1 }]",
        "registers = [{ index = 0xFFFF, count = 2, at = 0 }]", "inputs = 33", "speed = 3"})
    EXPECT_FALSE(parse_rules(head + bad, "x1.toml")) << bad;
  EXPECT_FALSE(parse_rules("format = 1\nfamily = \"x1\"\n", "x1.toml")->modbus.exists());
}

TEST(Rules, NameWhatEnergisesAMotorWithoutTheControlwordAndWhatEndsIt) {
  const std::string head = "format = 1\nfamily = \"x1\"\n[motion]\nwithout_controlword = ";
  const auto rules = parse_rules(head + R"([{ name = "P1", end = "P2", value = 1 }])", "x1.toml");
  ASSERT_TRUE(rules) << rules.error().message.text();
  ASSERT_EQ(rules->motion.without_controlword.size(), 1U);
  EXPECT_EQ(rules->motion.without_controlword.front().name, "P1");
  EXPECT_EQ(rules->motion.without_controlword.front().end, "P2");
  EXPECT_EQ(rules->motion.without_controlword.front().value, 1);
  for (const auto* wrong : {"[\"P1\"]", "[{ name = \"P1\" }]", "[{ name = \"P1\", end = 2, value = 1 }]",
                            "{ name = \"P1\", end = \"P2\", value = 1 }"})
    EXPECT_FALSE(parse_rules(head + wrong, "x1.toml")) << wrong;
}

TEST(Rules, NameOnlyParametersThatThereAreAsEnergisingAMotor) {
  const std::vector<std::filesystem::path> folders{std::filesystem::path(source_dir()) / "eds"};
  for (const auto* family : {"ts", "gsd600"}) {
    const auto profile = load_profile(family, folders);
    ASSERT_TRUE(profile) << profile.error().message.text();
    EXPECT_GE(profile->rules.motion.without_controlword.size(), 2U);
    for (const auto& parameter : profile->rules.motion.without_controlword) {
      const auto place = place_of(*profile, parameter.name);
      ASSERT_TRUE(place) << parameter.name;
      EXPECT_TRUE(place_of(*profile, parameter.end)) << parameter.end;
      const Bytes on{1, 0};
      const Bytes off{0, 0};
      EXPECT_EQ(power_parameter(&*profile, *place, on), &parameter);
      EXPECT_EQ(power_parameter(&*profile, *place, off), nullptr);
      EXPECT_EQ(power_parameter(nullptr, *place, on), nullptr);
    }
  }
}

TEST(Rules, KnowSeveralWaysToOneMeasureAndWordsInTwoLanguages) {
  const auto rules = parse_rules(R"(
format = 1
family = "x1"
contradicted = ["motion.enable 64 184"]
[units]
increments_per_turn = [
  { multiply = ["0x2000:01"], when = [{ object = "0x2000:00", value = 1 }] },
  { power_of_two = ["0x2000:02"], when = [{ object = "0x2000:00", value = 0 }] },
]
rated_torque = { multiply = [2] }
[abort_codes]
0x080000A1 = { text = "Object error", text_zh = "对象错误" }
)",
                                 "x1.toml");
  ASSERT_TRUE(rules) << rules.error().message.text();
  const auto& ways = rules->units.at(Measure::increments_per_turn);
  ASSERT_EQ(ways.size(), 2U);
  EXPECT_EQ(ways[1].objects(), (std::vector<ObjectAddress>{{0x2000, 2}, {0x2000, 0}}));
  EXPECT_EQ(rules->units.at(Measure::rated_torque).size(), 1U);
  EXPECT_EQ(rules->abort_texts.at(0x0800'00A1).text, "Object error");
  EXPECT_EQ(rules->abort_texts.at(0x0800'00A1).text_zh, "对象错误");
  EXPECT_EQ(rules->contradicted, (std::vector<od::Mark>{{"motion.enable", {64, 184}}}));
}

TEST(Rules, WithAContradictionWithoutLinesAreRefused) {
  EXPECT_FALSE(parse_rules("format = 1\nfamily = \"x\"\ncontradicted = [\"motion.enable\"]\n", "x.toml"));
  EXPECT_FALSE(parse_rules("format = 1\nfamily = \"x\"\n[units]\nrated_torque = []\n", "x.toml"));
}

void expect_refused(const char* text, const char* message) {
  const auto rules = parse_rules(text, "x.toml");
  ASSERT_FALSE(rules) << text;
  EXPECT_EQ(rules.error().code, Errc::file);
  EXPECT_EQ(rules.error().message.text(), message);
}

TEST(Rules, WithAMisspeltKeyAreRefusedBecauseTheRuleWouldSilentlyNotHold) {
  expect_refused("format = 1\nfamliy = \"x\"\n", "x.toml:2:1: unknown key 'famliy'");
  expect_refused("format = 1\n[sdo]\nsegmentd = false\n", "x.toml:3:1: unknown key 'segmentd'");
}

TEST(Rules, WithAValueOfTheWrongKindAreRefusedWithItsPlace) {
  expect_refused("format = 1\n[sdo]\nsegmented = \"no\"\n", "x.toml:3:13: 'segmented' cannot be \"no\"");
  expect_refused("format = 1\n[[numbering]]\nblock = 0\n", "x.toml:3:9: 'block' cannot be 0");
  expect_refused("format = 1\n[[numbering]]\nfirst_sub = 300\n", "x.toml:3:13: 'first_sub' cannot be 300");
  expect_refused("format = 2\n", "x.toml:1:10: 'format' cannot be 2");
}

TEST(Rules, ThatAreNoTomlAreRefusedWithLine) {
  const auto rules = parse_rules("format = 1\nfamily = \n", "x.toml");
  ASSERT_FALSE(rules);
  EXPECT_EQ(rules.error().code, Errc::file);
  EXPECT_EQ(rules.error().line, 2U);
}

TEST(Rules, MayBeAnyGarbage) {
  for (const auto* text : {"[=]", "[[.]]", "= 1", "[a", "\"", "a = [", "\xFF\xFE"})
    EXPECT_FALSE(parse_rules(text, "x.toml")) << text;
}

TEST(Rules, NameTheirFormatAndFamily) {
  for (const auto* text : {"", "family = \"x1\"", "format = 1", "format = 1\nfamily = \"\""}) {
    const auto rules = parse_rules(text, "x1.toml");
    ASSERT_FALSE(rules) << text;
    EXPECT_EQ(rules.error().message.text(), "x1.toml: 'format' or 'family' is missing");
  }
}

}  // namespace
}  // namespace servoctl::drive
