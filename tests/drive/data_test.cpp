// Every family in eds/ loads, agrees with itself and keeps the rules that docs/drive-data.md promises.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <set>

#include "base/file.hpp"
#include "base/number.hpp"
#include "drive/naming.hpp"
#include "drive/parameter_ids.hpp"
#include "drive/quantity.hpp"
#include "od/eds.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::drive {
namespace {

class DriveData : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    auto loaded = load_profile(GetParam(), kFolders);
    ASSERT_TRUE(loaded) << loaded.error().message.text();
    profile = std::move(*loaded);
    if (profile.made_of_dictionary) profile.parameters.clear();  // These tests are about tables.
  }
  Profile profile;
};

TEST_P(DriveData, LoadsWithoutASingleFinding) {
  EXPECT_TRUE(profile.warnings.empty()) << profile.warnings.front();
  EXPECT_FALSE(profile.dictionary.empty());
  EXPECT_FALSE(profile.faults.empty());
  EXPECT_EQ(profile.rules.family, GetParam());
  EXPECT_FALSE(profile.rules.vendor.empty());
  EXPECT_FALSE(profile.rules.name_zh.empty());
}

TEST_P(DriveData, KeepsTheAddressRuleForEveryParameter) {
  if (profile.rules.numbering.empty()) return;
  for (const auto& p : profile.parameters) {
    int rules = 0;
    for (const auto& rule : profile.rules.numbering) {
      const auto number = rule.number(p.id);
      if (!number) continue;
      ++rules;
      EXPECT_EQ(p.object, rule.object(*number)) << p.id;
    }
    EXPECT_EQ(rules, 1) << p.id;
  }
}

TEST_P(DriveData, HasEveryIdObjectAndNameOnce) {
  std::set<std::string> ids;
  std::set<ObjectAddress> objects;
  std::set<std::string> names;
  for (const auto& p : profile.parameters) {
    EXPECT_TRUE(ids.insert(canonical_id(p.id)).second) << p.id;
    if (p.object) {
      EXPECT_TRUE(objects.insert(*p.object).second) << p.id;
    }
    EXPECT_TRUE(names.insert(od::identifier(p.name)).second) << p.name;
    EXPECT_TRUE(!p.name_zh.empty() || p.doubts.about("name")) << p.id;
    EXPECT_GT(p.line, 0U) << p.id;
  }
}

void expect_in_order(std::string_view what, const std::optional<od::Value>& low,
                     const std::optional<od::Value>& value, const std::optional<od::Value>& high) {
  if (low && value) {
    EXPECT_LE(od::compare_numbers(*low, *value), 0) << what;
  }
  if (value && high) {
    EXPECT_LE(od::compare_numbers(*value, *high), 0) << what;
  }
  if (low && high) {
    EXPECT_LE(od::compare_numbers(*low, *high), 0) << what;
  }
}

TEST_P(DriveData, NamesEveryObjectAndEntryInChinese) {
  for (const auto& object : profile.dictionary.objects()) {
    if (object.entries.size() > 1) {
      EXPECT_NE(object.name_zh, "") << fmt::format("{:04X}h", object.index);
    }
    for (const auto& entry : object.entries)
      if (profile.parameter(entry.address) == nullptr) {
        EXPECT_NE(entry.name_zh, "") << to_string(entry.address);
      }
  }
}

TEST_P(DriveData, HasDefaultsWithinLimitsAndWithinTheirType) {
  for (const auto& p : profile.parameters) {
    expect_in_order(p.id, p.min, p.default_value, p.max);
    for (const auto& value : {p.default_value, p.min, p.max})
      if (value) {
        EXPECT_TRUE(od::encode(p.type, *value)) << p.id;
      }
  }
  const auto plain = [](const std::optional<od::NodeValue>& v) {
    return v ? std::optional(v->for_node(1)) : std::nullopt;
  };
  for (const auto& object : profile.dictionary.objects())
    for (const auto& e : object.entries)
      expect_in_order(to_string(e.address), plain(e.low), plain(e.default_value), plain(e.high));
}

TEST_P(DriveData, HasLabelsThatTheirParameterCanTake) {
  for (const auto& p : profile.parameters) {
    auto m = meaning({{}, nullptr, &p, {}, false}, 1);
    for (const auto& label : p.labels) {
      const auto value = od::parse_value(p.type, fmt::format("{}", label.value));
      ASSERT_TRUE(value) << p.id << " " << label.label;
      EXPECT_TRUE(check_limits(m, *value)) << p.id << " " << label.label;
    }
  }
}

TEST_P(DriveData, TellsTheSameOfAParameterInItsTableAndInItsEds) {
  for (const auto& p : profile.parameters) {
    if (!p.object) continue;
    const auto* entry = profile.dictionary.find(*p.object);
    ASSERT_NE(entry, nullptr) << p.id;
    EXPECT_EQ(entry->name, p.id + " " + p.name);
    EXPECT_EQ(entry->type, p.type) << p.id;
    EXPECT_EQ(entry->access, p.access) << p.id;
    const auto same = [&](const std::optional<od::NodeValue>& a, const std::optional<od::Value>& b) {
      return a.has_value() == b.has_value() && (!a || od::compare_numbers(a->value, *b) == 0);
    };
    EXPECT_TRUE(same(entry->default_value, p.default_value)) << p.id;
    EXPECT_TRUE(same(entry->low, p.min)) << p.id;
    EXPECT_TRUE(same(entry->high, p.max)) << p.id;
  }
}

TEST_P(DriveData, HasAnEffectForWhatCanBeWrittenAndNoneForTheRest) {
  for (const auto& p : profile.parameters)
    EXPECT_EQ(p.effect == od::Effect::unstated, !od::writable(p.access)) << p.id;
  for (const auto& object : profile.dictionary.objects())
    for (const auto& e : object.entries) {
      if (profile.parameter(e.address) != nullptr || e.effect == od::Effect::unstated) continue;
      EXPECT_TRUE(od::writable(e.access)) << to_string(e.address);
    }
}

TEST_P(DriveData, NamesRulesAfterParametersAndObjectsThatExist) {
  const auto& rules = profile.rules;
  std::vector<std::string> names{rules.nmt.node_id,
                                 rules.nmt.bitrate,
                                 rules.nmt.autostart,
                                 rules.nmt.guarding_alarm,
                                 rules.pdo.assign_rpdo,
                                 rules.pdo.assign_tpdo,
                                 rules.store.flash_switch,
                                 rules.store.unlock,
                                 rules.store.restore_at_start,
                                 rules.store.clear_alarms_at_start,
                                 rules.fault.alarm};
  for (const auto* settings :
       {&rules.nmt.needs, &rules.store.store, &rules.store.restore, &rules.fault.reset})
    for (const auto& setting : *settings) names.push_back(setting.name);
  for (const auto& caution : rules.cautions) names.push_back(caution.name);
  names.push_back(rules.motion.rated_torque);
  names.push_back(rules.motion.rated_speed);
  for (const auto& alarm : rules.nmt.lost_alarms)
    EXPECT_TRUE(std::any_of(profile.faults.begin(), profile.faults.end(), [&](const auto& fault) {
      return fault.panel == alarm;
    })) << alarm;
  names.insert(names.end(), rules.motion.speed_limit.begin(), rules.motion.speed_limit.end());
  for (const auto& name : names) {
    if (name.empty() || profile.parameter(name) != nullptr) continue;
    const auto target = resolve(&profile, name);
    ASSERT_TRUE(target) << name;
    EXPECT_TRUE(target->entry != nullptr || profile.dictionary.object(target->address.index) != nullptr)
        << name;
  }
  std::vector<ObjectAddress> objects = rules.mirror_add_node_id;
  for (const auto& condition : rules.identity) objects.push_back(condition.object);
  for (const auto& [measure, ways] : rules.units)
    for (const auto& way : ways)
      for (const auto object : way.objects()) objects.push_back(object);
  for (const auto& p : profile.parameters)
    if (p.mirror) objects.push_back(*p.mirror);
  for (const auto& object : objects) EXPECT_NE(profile.dictionary.find(object), nullptr) << to_string(object);
  for (const auto& panel : {rules.fault.length_alarm, rules.fault.mapping_alarm, rules.fault.range_alarm,
                            rules.fault.access_alarm, rules.fault.object_alarm, rules.fault.sub_index_alarm})
    EXPECT_TRUE(panel.empty() || std::any_of(profile.faults.begin(), profile.faults.end(),
                                             [&](const Fault& f) { return f.panel == panel; }))
        << panel;
}

TEST_P(DriveData, MovesInModesItsTableKnows) {
  const auto modes = meaning(target_at(&profile, {0x6060, 0}), 0);
  const auto& motion = profile.rules.motion;
  for (const auto& mode : {motion.position, motion.velocity, motion.torque, motion.homing})
    if (mode) {
      EXPECT_NE(label_of(modes, od::Value(std::int64_t{*mode})), nullptr) << int{*mode};
    }
}

TEST_P(DriveData, FindsEveryNameItOffers) {
  for (const auto& name : names(profile)) {
    const auto* parameter = profile.parameter(name);
    if (parameter != nullptr && !parameter->object) continue;
    const auto target = resolve(&profile, name);
    EXPECT_TRUE(target) << name << ": " << (target ? "" : target.error().message.text());
  }
}

INSTANTIATE_TEST_SUITE_P(Families, DriveData,
                         testing::Values("cia402", "da200", "dm", "gsd600", "sv2", "ts"));

TEST(DriveFolders, HoldNoFamilyThatIsNotTested) {
  std::vector<std::string> found;
  for (const auto& family : find_families(kFolders)) found.push_back(family.name);
  EXPECT_EQ(found, (std::vector<std::string>{"cia402", "da200", "dm", "gsd600", "sv2", "ts"}));
}

}  // namespace
}  // namespace servoctl::drive
