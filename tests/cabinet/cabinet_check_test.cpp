#include "cabinet/cabinet_check.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "base/file.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cabinet {
namespace {

Result<const drive::Profile*> checked_family(const std::string& family) {
  static std::map<std::string, drive::Profile> known;
  if (known.count(family) == 0) {
    auto profile = drive::load_profile(family, kFolders);
    if (!profile) return fail(profile.error());
    known.emplace(family, std::move(*profile));
  }
  return &known.at(family);
}

/// The errors of a cabinet, one a line; empty when there are none.
std::string found(std::string_view toml) {
  const auto cabinet = parse_cabinet(toml, "c.toml");
  EXPECT_TRUE(cabinet) << cabinet.error().message.text();
  std::string out;
  for (const auto& error : check_cabinet(*cabinet, checked_family).errors) {
    EXPECT_EQ(error.code, Errc::file);
    out += error.message.text() + "\n";
  }
  return out;
}

std::string axis(std::string_view family, std::string_view lines) {
  return "[bus.main]\nurl = \"can0\"\n[axis.feeder]\nnode = 1\nfamily = \"" + std::string(family) + "\"\n" +
         std::string(lines);
}

TEST(CabinetCheck, FindsNothingInWhatADriveCanHave) {
  EXPECT_EQ(found(axis("gsd600",
                       "heartbeat = \"500ms\"\npdos = \"pp\"\nper_turn = \"20 mm\"\n"
                       "limits = { speed = \"20mm/s\", torque = \"50%\", window = \"3rev\" }\n"
                       "parameters = { Pn0202 = 2, \"0x6065\" = 1000 }\n")),
            "");
  for (const auto* family : {"dm", "da200", "ts", "sv2"}) EXPECT_EQ(found(axis(family, "")), "") << family;
}

TEST(CabinetCheck, FindsNamesThatDifferInTheCaseOfLettersAlone) {
  const std::string rest = "family = \"gsd600\"\nbus = \"main\"\n";
  const auto alike =
      found("[bus.main]\nurl = \"can0\"\n[bus.MAIN]\nurl = \"can1\"\n[group.Z]\n[axis.lift]\nnode = 1\n" +
            rest + "group = [\"Z\"]\n[axis.Lift]\nnode = 2\n" + rest + "[axis.z]\nnode = 3\n" + rest);
  EXPECT_NE(alike.find("c.toml:3:1: bus MAIN differs from main in the case of letters alone\n"),
            std::string::npos)
      << alike;
  EXPECT_NE(alike.find("axis Lift differs from lift in the case"), std::string::npos) << alike;
  EXPECT_NE(alike.find("group Z differs from z in the case"), std::string::npos) << alike;
}

TEST(CabinetCheck, FindsNothingInTheExampleOfTheDocs) {
  const auto text = read_file(std::filesystem::path(source_dir()) / "docs/cabinet.md", 1U << 20U).value();
  const auto begin = text.find("```toml\n") + 8;
  const auto example = text.substr(begin, text.find("```", begin) - begin);
  EXPECT_NE(example.find("[axis.lift]"), std::string::npos);
  EXPECT_EQ(found(example), "");
}

TEST(CabinetCheck, NamesWhatNoDriveOfTheFamilyTakes) {
  EXPECT_EQ(found(axis("gsd600", "parameters = { Pn9999 = 1 }\n")),
            "c.toml:6:16: axis feeder: 'Pn9999' is not an object or parameter of gsd600\n");
  EXPECT_EQ(found(axis("gsd600", "parameters = { \"0x6040\" = 6 }\n")),
            "c.toml:6:16: axis feeder: 0x6040 is no setting: process data\n");
  EXPECT_EQ(found(axis("gsd600", "parameters = { Pn0048 = 5 }\n")),
            "c.toml:6:16: axis feeder: Pn0048 is node-ID or bitrate of the drive\n");
  EXPECT_EQ(found(axis("da200", "[axis.feeder.parameters]\n\"0x6065\" = 5\nfollowing_error_window = 6\n")),
            "c.toml:8:1: axis feeder: following_error_window is 0x6065 as well, in line 7\n");
  EXPECT_EQ(found(axis("gsd600", "parameters = { Pn0202 = \"5 apples\" }\n")).substr(0, 32),
            "c.toml:6:16: axis feeder: Pn0202");
  EXPECT_EQ(found(axis("gsd600", "pdos = \"xx\"\n")),
            "c.toml:6:8: axis feeder: gsd600 has no PDO preset 'xx'\n");
  EXPECT_EQ(found(axis("gsd600", "pdos = [ { pdo = \"TPDO1\", map = [\"statuswort\"] } ]\n")),
            "c.toml:6:8: axis feeder: TPDO1: 'statuswort' is not an object or parameter of gsd600\n");
  EXPECT_EQ(found(axis("gsd600", "pdos = \"nowhere.toml\"\n")).substr(0, 26), "c.toml:6:8: axis feeder: c");
  EXPECT_EQ(found(axis("nofam", "")), "c.toml:3:1: axis feeder: no drive family is called 'nofam'\n");
}

TEST(CabinetCheck, NamesLimitsThatLimitNothing) {
  for (const auto* bad :
       {"speed = \"20mm\"", "speed = \"0rpm\"", "speed = \"-5rpm\"", "speed = \"fast\"", "torque = \"50\"",
        "torque = \"5rpm\"", "window = \"2%\"", "following_error = \"1s\""})
    EXPECT_NE(found(axis("gsd600", "limits = { " + std::string(bad) + " }\n"))
                  .find("c.toml:6:10: axis feeder: limits: "),
              std::string::npos)
        << bad;
}

TEST(CabinetCheck, HoldsATorqueAgainstTheRangeOfTheDrivesOwnLimit) {
  EXPECT_EQ(found(axis("gsd600", "limits = { torque = \"400%\" }\n")), "");
  const auto above = found(axis("gsd600", "limits = { torque = \"401%\" }\n"));
  EXPECT_TRUE(above.starts_with("c.toml:6:10: axis feeder: limits: torque = \"401%\": 0x6072:0 Max torque: "))
      << above;
  EXPECT_EQ(found(axis("dm", "limits = { torque = \"800%\" }\n")), "") << "its 6072h is in Nm";
}

TEST(CabinetCheck, TellsOfObjectsThatTheFamilyDoesNotList) {
  const auto cabinet = parse_cabinet(
      "[bus.main]\nurl = \"can0\"\n[axis.\"a{1-2}\"]\nnode = \"1-2\"\nfamily = \"sv2\"\n"
      "parameters = { \"0x2FFF\" = 1, \"0x6083\" = 5 }\n",
      "c.toml");
  ASSERT_TRUE(cabinet);
  const auto findings = check_cabinet(*cabinet, checked_family);
  EXPECT_TRUE(findings.errors.empty());
  EXPECT_EQ(findings.notices,
            std::vector<Message>{"c.toml:6:16: axis a1: 0x2FFF is not in the data of sv2: its size and "
                                 "limits are asked of the drive"});
}

TEST(CabinetCheck, TellsOnceWhatManyAxesShare) {
  EXPECT_EQ(found("[bus.main]\nurl = \"can0\"\n[group.g]\nfamily = \"ts\"\nparameters = { PA-999 = 1 }\n"
                  "[axis.\"a{1-9}\"]\nnode = \"1-9\"\ngroup = \"g\"\n"),
            "c.toml:5:16: axis a1: 'PA-999' is not an object or parameter of ts\n");
}

}  // namespace
}  // namespace servoctl::cabinet
