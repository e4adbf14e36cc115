#include <gtest/gtest.h>

#include "cabinet/cabinet.hpp"
#include "cabinet/name_pattern.hpp"

namespace servoctl::cabinet {
namespace {

constexpr std::string_view kTwoBuses = R"(
[bus.main]
url = "can0"
bitrate = "500k"
[bus.ring]
url = "coe:eth0"

[family.gsd600]
heartbeat = "500ms"
parameters = { Pn0202 = 1, Pn0301 = "5ms" }

[group.feeders]
family = "gsd600"
bus = "main"
gear = "10:1"
per_turn = "20 mm"
limits = { speed = "300mm/s", torque = "80%" }
parameters = { Pn202 = 2 }

[axis."feeder{1-3}"]
node = "1-3"
group = "feeders"

[axis.lift]
node = 4
group = "feeders"
serial = "0x1234"
turn = 131072
heartbeat = "100ms"
limits = { speed = "50mm/s" }
[axis.lift.parameters]
"0x6065" = 1000
Pn0202 = 3

[axis.table]
bus = "ring"
node = 4
family = "sv2"
pdos = "pp"
)";

std::string refused(std::string_view toml) {
  const auto cabinet = parse_cabinet(toml, "cabinet.toml");
  if (cabinet) return "accepted";
  EXPECT_EQ(cabinet.error().code, Errc::file);
  return cabinet.error().message.text() + "|" + cabinet.error().hint.text();
}

std::string with_axis(std::string_view lines) {
  return "[bus.main]\nurl = \"can0\"\n[axis.feeder]\nnode = 1\nfamily = \"ts\"\n" + std::string(lines);
}

const Setting* setting(const Axis& axis, std::string_view name) {
  for (const auto& one : axis.parameters)
    if (one.name == name) return &one;
  return nullptr;
}

TEST(CabinetFile, GivesAnAxisWhatItsGroupAndFamilySayWhereItSaysNothing) {
  const auto cabinet = parse_cabinet(kTwoBuses, "cabinet.toml");
  ASSERT_TRUE(cabinet) << cabinet.error().message.text();
  ASSERT_EQ(cabinet->axes.size(), 5U);
  const auto& lift = *cabinet->axis("lift");
  EXPECT_EQ(lift.bus, "main");
  EXPECT_EQ(lift.family, "gsd600");
  EXPECT_EQ(lift.heartbeat, Duration(std::chrono::milliseconds(100)));
  EXPECT_EQ(lift.limits.speed, "50mm/s");
  EXPECT_EQ(lift.limits.torque, "80%");
  EXPECT_EQ(lift.serial, 0x1234U);
  EXPECT_EQ(lift.turn, 131072U);
  ASSERT_TRUE(lift.load);
  EXPECT_EQ(lift.load->unit, "mm");
  EXPECT_DOUBLE_EQ(lift.load->per_rev, 2.0);
  ASSERT_EQ(lift.parameters.size(), 3U);  // Pn0202 once, however it is written.
  EXPECT_EQ(setting(lift, "Pn0202")->value, "3");
  EXPECT_EQ(setting(lift, "Pn0301")->value, "5ms");
  EXPECT_EQ(setting(*cabinet->axis("feeder2"), "Pn202")->value, "2");
  EXPECT_EQ(cabinet->axis("feeder2")->heartbeat, Duration(std::chrono::milliseconds(500)));
  EXPECT_EQ(cabinet->axis("table")->pdos.preset, "pp");
  EXPECT_EQ(cabinet->axis("table")->heartbeat, std::nullopt);
}

TEST(CabinetFile, MakesFortyAxesOfOneTable) {
  const auto cabinet = parse_cabinet(
      "[bus.main]\nurl = \"can0\"\n[axis.\"feeder{01-40}\"]\nnode = \"1-40\"\nfamily = \"ts\"\n", "c.toml");
  ASSERT_TRUE(cabinet) << cabinet.error().message.text();
  ASSERT_EQ(cabinet->axes.size(), 40U);
  EXPECT_EQ(cabinet->axes.front().name, "feeder01");
  EXPECT_EQ(cabinet->axes.back().name, "feeder40");
  EXPECT_EQ(cabinet->axes.back().node, 40);
}

TEST(CabinetFile, SelectsAxesByNameGroupAndAllInTheOrderOfTheFile) {
  const auto cabinet = parse_cabinet(kTwoBuses, "cabinet.toml");
  ASSERT_TRUE(cabinet);
  const auto names = [&](std::string_view list) {
    std::string out;
    const auto chosen = cabinet->select(list);
    if (!chosen) return chosen.error().message.text() + "|" + chosen.error().hint.text();
    for (const auto* axis : *chosen) out += axis->name + " ";
    return out;
  };
  EXPECT_EQ(names("feeders"), "feeder1 feeder2 feeder3 lift ");
  EXPECT_EQ(names("table, feeder2,feeder2"), "feeder2 table ");
  EXPECT_EQ(names("all"), "feeder1 feeder2 feeder3 lift table ");
  EXPECT_EQ(names("lifd"), "cabinet.toml has no axis 'lifd'|did you mean lift?");
  EXPECT_EQ(cabinet->at("ring", 4)->name, "table");
  EXPECT_EQ(cabinet->at("main", 4)->name, "lift");
  EXPECT_EQ(cabinet->at("main", 9), nullptr);
}

TEST(CabinetFile, TellsWithLineAndColumnWhatItCannotUse) {
  EXPECT_EQ(refused(with_axis("speeed = 1\n")),
            "cabinet.toml:6:1: unknown key 'speeed'|write one of bus, encoder, family, gear, group, "
            "heartbeat, limits, node, parameters, pdos, per_turn, serial or turn");
  EXPECT_EQ(refused(with_axis("nod = 1\n")), "cabinet.toml:6:1: unknown key 'nod'|did you mean node?");
  EXPECT_EQ(
      refused(with_axis("turn = 0\n")),
      "cabinet.toml:6:8: 'turn' cannot be 0|write turn = 131072: increments of 6064h per motor revolution");
  EXPECT_EQ(
      refused(with_axis("heartbeat = 100\n")),
      "cabinet.toml:6:13: 'heartbeat' cannot be 100|write heartbeat = \"100ms\" (at most 65535ms), or \"off\"");
  EXPECT_EQ(
      refused(with_axis("heartbeat = \"70s\"\n")),
      "cabinet.toml:6:13: 'heartbeat' cannot be \"70s\"|write heartbeat = \"100ms\" (at most 65535ms), or \"off\"");
  EXPECT_EQ(refused(with_axis("limits = { sped = \"1rpm\" }\n")),
            "cabinet.toml:6:12: unknown key 'sped'|did you mean speed?");
  EXPECT_EQ(refused(with_axis("parameters = { PA1 = true }\n")),
            "cabinet.toml:6:22: the value of 'PA1' is no number and no text|");
  EXPECT_EQ(refused(with_axis("parameters = { Pn0202 = 1, Pn202 = 1 }\n")),
            "cabinet.toml:6:36: 'Pn0202' and 'Pn202' are the same|");
  EXPECT_EQ(
      refused(with_axis("per_turn = \"360 deg\"\n")),
      "cabinet.toml:6:12: per_turn: 'deg' is a unit of the motor or of time|a rotating load needs a unit "
      "of another name: \"360 tabledeg\"");
  EXPECT_EQ(refused(with_axis("group = \"feeders\"\n")),
            "cabinet.toml:3:1: axis feeder: there is no [group.feeders]|");
  EXPECT_EQ(refused(with_axis("bus = \"man\"\n")),
            "cabinet.toml:3:1: axis feeder: there is no [bus.man]|did you mean main?");
  EXPECT_EQ(refused("[bus.main]\nurl = \"can0\"\nbitrate = \"fast\"\n"),
            "cabinet.toml:3:11: 'bitrate' cannot be \"fast\"|write bitrate = \"500k\" (10k, 20k, "
            "50k, 100k, 125k, 250k, 500k, 800k or 1M)");
  EXPECT_TRUE(refused("[bus.main]\nurl = \"can0\"\nbitrate = \"501k\"\n")
                  .starts_with("cabinet.toml:3:11: 'bitrate' cannot be \"501k\""));
  EXPECT_EQ(
      refused("[bus.main]\nurl = \"local:\"\n"),
      "cabinet.toml:2:7: bus main: 'local:' names no bus|write can0, slcan:/dev/ttyACM0@500k, "
      "socketcand://HOST/can0, gateway://HOST, coe:eth0, modbus:/dev/ttyUSB0@19200,8E1, local:NAME, sim:FAMILY@NODE or "
      "replay:FILE");
  EXPECT_TRUE(
      refused("[bus.main]\nurl = \"modbus:/dev/ttyS0\"\n")
          .starts_with("cabinet.toml:2:7: bus main: drives on Modbus cannot stand in a cabinet file|"));
  EXPECT_EQ(refused("[bus.main]\nurl = \"lokal:x\"\n"),
            "cabinet.toml:2:7: bus main: 'lokal:x' is not a bus|did you mean local?");
  EXPECT_EQ(refused("[bus.main]\nurl = \"can0\n").substr(0, 21), "cabinet.toml:2:12: Er");
  EXPECT_NE(refused("[bus.main]\nurl = \"can0\n").find("|one key = value a line"), std::string::npos);
  EXPECT_EQ(refused("[axis.a]\nnode = 1\nfamily = \"ts\"\n"),
            "cabinet.toml has no bus|write [bus.main] with url = \"can0\"");
  EXPECT_EQ(refused("[bus.main]\nurl = \"can0\"\n"),
            "cabinet.toml has no axis|write [axis.NAME] with node and family");
  EXPECT_EQ(
      refused("[bus.a]\nurl = \"can0\"\n[bus.b]\nurl = \"can0\"\n"),
      "cabinet.toml:3:1: bus b is can0, and so is bus a|one interface is one bus: put its axes on one of them");
  EXPECT_TRUE(refused("[bus.main\n").starts_with("cabinet.toml:1:10: ")) << refused("[bus.main\n");
}

TEST(CabinetFile, RefusesTwoAxesAtOnePlaceAndOneNameForTwo) {
  EXPECT_EQ(refused(with_axis("[axis.lift]\nnode = 1\nfamily = \"ts\"\n")),
            "cabinet.toml:6:1: axis lift: node 1 on bus main is axis feeder already|");
  EXPECT_EQ(
      refused("[bus.main]\nurl = \"can0\"\n[group.lift]\n[axis.lift]\nnode = 1\nfamily = \"ts\"\n"),
      "cabinet.toml:4:1: 'lift' is the name of two things|axes and groups share their names: -n takes both");
  EXPECT_EQ(refused("[bus.main]\nurl = \"can0\"\n[axis.\"f{1-3}\"]\nnode = \"1-2\"\nfamily = \"ts\"\n"),
            "cabinet.toml:3:1: axis f{1-3}: 3 names for 2 nodes|");
  EXPECT_EQ(refused("[bus.main]\nurl = \"can0\"\n[axis.\"f{3-1}\"]\nnode = \"1-2\"\nfamily = \"ts\"\n"),
            "cabinet.toml:3:1: 'f{3-1}': write a rising range in the braces, as feeder{1-40}|");
  EXPECT_EQ(
      refused("[bus.main]\nurl = \"can0\"\n[axis.\"f{1-2}\"]\nnode = \"1-2\"\nfamily = \"ts\"\nserial = 5\n"),
      "cabinet.toml:3:1: axis f{1-2}: each drive has a serial number of its own|");
}

TEST(CabinetNames, AreLettersOfAnyScriptAndNothingThatMeansSomethingElse) {
  for (const auto* good : {"feeder", "送料", "x-axis_2", "Achse1", "é"}) EXPECT_TRUE(is_name(good)) << good;
  for (const auto* bad : {"", "all", "ALL", "1", "3x", "-x", "a b", "a,b", "a.b",
                          "a\xC2\xA0"
                          "b",
                          "a\xE2\x80\x8B"
                          "b",
                          "\xFF", "a=b", "a'b"})
    EXPECT_FALSE(is_name(bad)) << bad;
}

}  // namespace
}  // namespace servoctl::cabinet
