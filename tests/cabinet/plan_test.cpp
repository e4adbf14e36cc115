// A cabinet of drives of five families: its plan names what differs.
#include "cabinet/cabinet_plan.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "drive/bitrate.hpp"
#include "drive/drive_settings.hpp"
#include "drive/naming.hpp"
#include "fleet_checks.hpp"
#include "session/write.hpp"
#include "settings/comparison.hpp"
#include "settings/selection.hpp"

namespace servoctl::cabinet {
namespace {

TEST(CabinetPlan, NamesExactlyWhatDiffers) {
  Fleet fleet(10, 2);
  ASSERT_TRUE(fleet.apply());
  std::mt19937 random(7);
  std::size_t changed = 0;
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(round);
    const auto before = fleet.look();
    for (std::size_t i = 0; i < fleet.size(); ++i) {
      ASSERT_TRUE(before[i].plan);
      EXPECT_EQ(before[i].plan->different, 0U);
      for (const auto& entry : before[i].plan->wanted.entries)
        if (random() % 3 == 0) changed += change_at_the_panel(fleet, i, entry.object) ? 1U : 0U;
    }
    const auto looks = fleet.look();
    for (std::size_t i = 0; i < fleet.size(); ++i) {
      ASSERT_TRUE(looks[i].plan);
      std::set<std::string> differ;
      for (const auto& [object, data] : wanted_of(looks[i]))
        if (fleet.drive(i).value(object) != data) differ.insert(to_string(object));
      EXPECT_EQ(objects_of(looks[i].plan->differences), differ) << looks[i].axis->name;
      EXPECT_EQ(looks[i].plan->different, differ.size());
    }
    ASSERT_TRUE(fleet.apply());
    expect_no_errors(fleet);
  }
  EXPECT_GT(changed, 60U);
}

TEST(CabinetPlan, ListsApartWhatIsNeitherInTheFileNorFromTheFactory) {
  Fleet fleet(5);
  ASSERT_TRUE(fleet.apply());
  for (const auto& look : fleet.look({.unlisted = true})) {
    ASSERT_TRUE(look.plan) << look.plan.error().message.text();
    EXPECT_EQ(look.plan->unlisted_count, 0U)
        << look.axis->family << " " << report::to_text(look.plan->unlisted);
  }
  for (std::size_t i = 0; i < fleet.size(); ++i) {
    const auto& profile = family_of(fleet.cabinet.axes[i].family);
    const auto listed = wanted_of(fleet.look()[i]);
    std::set<std::string> changed;
    for (const auto& setting : drive::settings_of(profile)) {
      const auto object = setting.entry->address;
      const bool free = setting.left_out.empty() && listed.count(object) == 0 && object.index >= 0x2000 &&
                        setting.entry->default_value && !settings::is_address(&profile, object);
      if (free && changed.size() < 3 && change_at_the_panel(fleet, i, object))
        changed.insert(to_string(object));
    }
    const auto look = fleet.look({.unlisted = true})[i];
    EXPECT_EQ(objects_of(look.plan->unlisted), changed) << profile.family;
    EXPECT_EQ(look.plan->different, 0U);
    EXPECT_EQ(fleet.look({.unlisted = false})[i].plan->unlisted_count, 0U);
  }
}

/// A group of parameters is a part of one family; the axes of the others have nothing in it.
TEST(CabinetPlan, OfAGroupLeavesOtherFamiliesAlone) {
  Fleet fleet(5);
  for (const auto& look : fleet.look({.only = "gain"})) {
    ASSERT_TRUE(look.plan) << look.plan.error().message.text();
    const auto& family = look.axis->family;
    if (family == "gsd600") {
      EXPECT_GT(look.plan->different, 0U);
    }
    if (!settings::selection_of(family_of(family), "gain")) {
      EXPECT_EQ(look.plan->different, 0U) << family;
    }
  }
}

TEST(CabinetPlan, RefusesAnotherDriveAndTellsBothSerialNumbers) {
  Fleet fleet(5);
  bool told = false;
  for (std::size_t i = 0; i < fleet.size(); ++i) {
    fleet.cabinet.axes[i].serial = 4711;
    const auto look = fleet.look()[i];
    ASSERT_FALSE(look.plan) << look.axis->family;
    EXPECT_EQ(look.plan.error().code, Errc::refused);
    EXPECT_NE(look.plan.error().message.text().find("4711"), std::string::npos)
        << look.plan.error().message.text();
    const auto found = fleet.session(i).upload(fleet.cabinet.axes[i].node, {0x1018, 4});
    if (!found) continue;
    told = true;
    EXPECT_NE(look.plan.error().message.text().find(fmt::format("{}", load_le(*found))), std::string::npos);
    fleet.cabinet.axes[i].serial = static_cast<std::uint32_t>(load_le(*found));
    EXPECT_TRUE(fleet.look()[i].plan);
  }
  EXPECT_TRUE(told);
  std::swap(fleet.cabinet.axes[0].family, fleet.cabinet.axes[2].family);
  std::swap(fleet.cabinet.axes[0].parameters, fleet.cabinet.axes[2].parameters);
  const auto swapped = fleet.look()[2];
  ASSERT_FALSE(swapped.plan);
  EXPECT_EQ(swapped.plan.error().code, Errc::refused);
}

/// The axes whose drives store another bitrate than this one.
std::set<std::string> with_another_bitrate(Fleet& fleet, std::string_view rate) {
  std::set<std::string> out;
  for (std::size_t i = 0; i < fleet.size(); ++i) {
    const auto& profile = family_of(fleet.cabinet.axes[i].family);
    const auto object = drive::place_of(profile, profile.rules.nmt.bitrate);
    const auto code = drive::bitrate_code(profile, drive::parse_bitrate(rate).value());
    if (object && code && static_cast<std::int64_t>(load_le(fleet.drive(i).value(*object))) != *code)
      out.insert(fleet.cabinet.axes[i].name);
  }
  return out;
}

TEST(CabinetPlan, AStoredBitrateThatIsNotThatOfTheBusIsWritten) {
  Fleet fleet(5);
  ASSERT_TRUE(fleet.apply({.unlock = true}));
  std::size_t written = 0;
  for (const auto* rate : {"500k", "250k", "1M", "125k"}) {
    fleet.cabinet.buses[0].bitrate = rate;
    const auto others = with_another_bitrate(fleet, rate);
    written += others.size();
    for (const auto& look : fleet.look()) {
      ASSERT_TRUE(look.plan) << look.plan.error().message.text();
      EXPECT_EQ(look.plan->different, others.count(look.axis->name)) << look.axis->family << " " << rate;
      for (const auto& need : look.plan->needs) EXPECT_NE(need.kind, AxisNeed::Kind::restart);
    }
    ASSERT_TRUE(fleet.apply({.unlock = true}));
    expect_no_errors(fleet);
    EXPECT_EQ(with_another_bitrate(fleet, rate), std::set<std::string>{});
    EXPECT_EQ(fleet.different(), 0U);
  }
  EXPECT_GE(written, 8U);
}

/// Where the bus runs at another one than the file says, or nothing tells at which, it would lead away.
TEST(CabinetPlan, NoBitrateIsWrittenThatTheBusMayNotRunAt) {
  Fleet fleet(5);
  ASSERT_TRUE(fleet.apply({.unlock = true}));
  fleet.cabinet.buses[0].bitrate = "125k";
  const auto others = with_another_bitrate(fleet, "125k");
  ASSERT_GE(others.size(), 3U);
  const std::pair<std::string, std::string> buses[] = {
      {"socketcand://192.0.2.1/can0", "`address --bitrate 125k -n "},
      {"slcan:/dev/ttyACM0@250k", "bus bus0 runs at 250 kbit/s: no bitrate is written"}};
  for (const auto& [url, words] : buses) {
    fleet.call_buses(url);
    for (const auto& look : fleet.look({.unlisted = true})) {
      const auto told = std::count_if(
          look.notices.begin(), look.notices.end(),
          [&, &text = words](const auto& notice) { return notice.text().find(text) != std::string::npos; });
      EXPECT_EQ(told, static_cast<long>(others.count(look.axis->name))) << look.axis->family << " " << url;
      EXPECT_EQ(look.plan->different, 0U);
    }
    ASSERT_TRUE(fleet.apply({.unlock = true}));
    EXPECT_EQ(with_another_bitrate(fleet, "125k"), others);
  }
}

TEST(CabinetPlan, ANodeIdThatIsStoredForTheNextStartIsPutBack) {
  Fleet fleet(5);
  ASSERT_TRUE(fleet.apply({.unlock = true}));
  std::size_t moved = 0;
  for (std::size_t i = 0; i < fleet.size(); ++i) {
    const auto& axis = fleet.cabinet.axes[i];
    const auto& profile = family_of(axis.family);
    const auto object = drive::place_of(profile, profile.rules.nmt.node_id);
    if (!object) continue;
    const auto size = fleet.drive(i).value(*object).size();
    if (!fleet.session(i).download(axis.node, *object, store_le(100, size))) continue;  // Behind a password.
    const auto look = fleet.look()[i];
    ASSERT_TRUE(look.plan) << look.plan.error().message.text();
    EXPECT_EQ(objects_of(look.plan->differences), std::set<std::string>{to_string(*object)});
    ++moved;
  }
  EXPECT_GE(moved, 3U);
  ASSERT_TRUE(fleet.apply({.unlock = true}));
  expect_no_errors(fleet);
  fleet.power_cycle();
  for (const auto& look : fleet.look()) {
    ASSERT_TRUE(look.plan) << look.axis->family << ": it does not answer at its node any more";
    const auto& profile = family_of(look.axis->family);
    const auto object = drive::place_of(profile, profile.rules.nmt.node_id);
    if (object) {
      EXPECT_EQ(objects_of(look.plan->differences).count(to_string(*object)), 0U) << look.axis->family;
    }
  }
}

TEST(CabinetPlan, TellsWhatTheFileSaysWrongWithItsLine) {
  Fleet fleet(5);
  auto& parameters = fleet.cabinet.axes[2].parameters;
  const auto good = parameters;
  const auto refusal = [&] {
    const auto look = fleet.look()[2];
    return look.plan ? std::string("taken") : look.plan.error().message.text();
  };
  parameters = {{"Pn9999", "1", {7, 1}}};
  EXPECT_NE(refusal().find("cabinet.toml:7:1: axis axis3: "), std::string::npos) << refusal();
  parameters = {{"Pn0214", "99999", {8, 1}}};
  EXPECT_NE(refusal().find("cabinet.toml:8:1"), std::string::npos) << refusal();
  parameters = {{"Pn0214", "450", {8, 1}}, {"0x2001:F", "451", {9, 1}}};
  EXPECT_NE(refusal().find("another value in line 8"), std::string::npos) << refusal();
  parameters = {{"0x6040", "6", {8, 1}}};
  EXPECT_NE(refusal().find("not a setting"), std::string::npos) << refusal();
  fleet.cabinet.axes[3].heartbeat = 100ms;
  fleet.cabinet.axes[3].heartbeat_at = {33, 4};
  EXPECT_NE(
      fleet.look()[3].plan.error().message.text().find("cabinet.toml:33:4: axis axis4: sv2 has no heartbeat"),
      std::string::npos);
  parameters = good;
  EXPECT_EQ(refusal(), "taken");
}

}  // namespace
}  // namespace servoctl::cabinet
