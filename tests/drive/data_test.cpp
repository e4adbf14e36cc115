// Every family in eds/ loads, agrees with itself and keeps the rules that docs/drive-data.md promises.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <filesystem>
#include <set>

#include "base/file.hpp"
#include "base/number.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "od/eds.hpp"

namespace servoctl::drive {
namespace {

const std::filesystem::path kFolders[] = {std::filesystem::path(SERVOCTL_SOURCE_DIR) / "eds"};

class DriveData : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    auto loaded = load_profile(GetParam(), kFolders);
    ASSERT_TRUE(loaded) << loaded.error().message;
    profile = std::move(*loaded);
  }
  Profile profile;
};

TEST_P(DriveData, LoadsWithoutASingleFinding) {
  EXPECT_TRUE(profile.warnings.empty()) << profile.warnings.front();
  EXPECT_FALSE(profile.dictionary.empty());
  EXPECT_FALSE(profile.parameters.empty());
  EXPECT_FALSE(profile.faults.empty());
  EXPECT_EQ(profile.rules.family, GetParam());
  EXPECT_FALSE(profile.rules.identity.empty());
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
    EXPECT_FALSE(p.name_zh.empty()) << p.id;
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
    const auto m = meaning(target_at(&profile, *p.object), 1);
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

TEST_P(DriveData, NamesRulesAfterParametersThatExist) {
  const auto& rules = profile.rules;
  for (const auto& id : {rules.nmt.node_id, rules.nmt.bitrate, rules.nmt.autostart,
                         rules.store.restore_at_start, rules.store.clear_alarms_at_start})
    if (!id.empty()) {
      EXPECT_NE(profile.parameter(id), nullptr) << id;
    }
  for (const auto& object : rules.mirror_add_node_id)
    EXPECT_NE(profile.dictionary.find(object), nullptr) << to_string(object);
  for (const auto& p : profile.parameters)
    if (p.mirror) {
      EXPECT_NE(profile.dictionary.find(*p.mirror), nullptr) << p.id;
    }
}

TEST_P(DriveData, FindsEveryNameItOffers) {
  for (const auto& name : names(profile)) {
    const auto target = resolve(&profile, name);
    EXPECT_TRUE(target) << name << ": " << (target ? "" : target.error().message);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, DriveData, testing::Values("gsd600"));

TEST(DriveFolders, HoldNoFamilyThatIsNotTested) {
  std::vector<std::string> found;
  for (const auto& family : find_families(kFolders)) found.push_back(family.name);
  EXPECT_EQ(found, std::vector<std::string>{"gsd600"});
}

TEST(Gsd600Data, HasAsManyParametersAndObjectsAsTheManual) {
  const auto profile = load_profile("gsd600", kFolders);
  ASSERT_TRUE(profile);
  // Rows of the overview tables 4.3.1 to 4.3.7: lines 1764, 2057, 2712, 3203, 3801, 4393 and 5123 ff.
  const std::pair<unsigned, std::size_t> chapters[] = {{0, 25},   {100, 57}, {200, 43}, {300, 52},
                                                       {400, 51}, {600, 83}, {1000, 20}};
  for (std::size_t i = 0; i < std::size(chapters); ++i) {
    const unsigned first = chapters[i].first;
    const unsigned last = i + 1 < std::size(chapters) ? chapters[i + 1].first : 2000;
    std::size_t count = 0;
    for (const auto& p : profile->parameters) {
      const auto number = parse_digits(std::string_view(p.id).substr(2), 10).value_or(0);
      count += number >= first && number < last ? 1 : 0;
    }
    EXPECT_EQ(count, chapters[i].second) << "from Pn" << first;
  }
  EXPECT_EQ(profile->parameters.size(), 331U);
}

}  // namespace
}  // namespace servoctl::drive
