#include "drive/naming.hpp"
#include "drive/parameter_ids.hpp"

#include <gtest/gtest.h>

#include "tests/source_dir.hpp"

namespace servoctl::drive {
namespace {

od::Entry entry(ObjectAddress address, std::string name) {
  od::Entry out;
  out.address = address;
  out.name = std::move(name);
  return out;
}

od::Parameter parameter(std::string id, std::string name, std::optional<ObjectAddress> object) {
  od::Parameter out;
  out.id = std::move(id);
  out.name = std::move(name);
  out.object = object;
  return out;
}

Profile profile() {
  Profile out;
  out.family = "example";
  out.dictionary.add({0x6041, "Statusword", od::ObjectCode::var, {entry({0x6041, 0}, "Statusword")}});
  out.dictionary.add({0x6099,
                      "Homing speeds",
                      od::ObjectCode::array,
                      {entry({0x6099, 0}, "Highest sub-index supported"),
                       entry({0x6099, 1}, "Speed during search for switch"),
                       entry({0x6099, 2}, "Speed during search for zero")}});
  out.dictionary.add(
      {0x2001,
       "Gain",
       od::ObjectCode::record,
       {entry({0x2001, 0}, "Highest sub-index supported"), entry({0x2001, 3}, "Xn0202 Tuning")}});
  out.parameters = {parameter("Xn0202", "Tuning mode", ObjectAddress{0x2001, 3}),
                    parameter("Xn0009", "Panel brightness", std::nullopt)};
  out.build_index();
  return out;
}

ObjectAddress found(const Profile& p, std::string_view text) {
  const auto target = resolve(&p, text);
  EXPECT_TRUE(target) << text << ": " << (target ? "" : target.error().message.text());
  return target ? target->address : ObjectAddress{};
}

TEST(Resolve, TakesAllWaysToWriteAnAddressWithoutADictionary) {
  for (const auto* text :
       {"0x6099:1", "6099h.1", "6099sub1", "6099H:01", "0X6099SUB1", "6099h.1h", "6099:1"}) {
    const auto target = resolve(nullptr, text);
    ASSERT_TRUE(target) << text;
    EXPECT_EQ(target->address, (ObjectAddress{0x6099, 1})) << text;
  }
  EXPECT_EQ(resolve(nullptr, "6041")->address, (ObjectAddress{0x6041, 0}));
  EXPECT_EQ(resolve(nullptr, "0x2000:65")->address, (ObjectAddress{0x2000, 0x65}));
}

TEST(Resolve, WithoutADictionarySaysHowToGetOne) {
  const auto target = resolve(nullptr, "statusword");
  ASSERT_FALSE(target);
  EXPECT_EQ(target.error().code, Errc::usage);
  EXPECT_NE(target.error().hint.text().find("-d FAMILY"), std::string::npos);
}

TEST(Resolve, FindsObjectsAndEntriesByName) {
  const auto p = profile();
  EXPECT_EQ(found(p, "statusword"), (ObjectAddress{0x6041, 0}));
  EXPECT_EQ(found(p, "StatusWord"), (ObjectAddress{0x6041, 0}));
  EXPECT_EQ(found(p, "homing_speeds.switch"), (ObjectAddress{0x6099, 1}));
  EXPECT_EQ(found(p, "Homing speeds.zero"), (ObjectAddress{0x6099, 2}));
  EXPECT_EQ(found(p, "homing_speeds.speed_during_search_for_zero"), (ObjectAddress{0x6099, 2}));
}

TEST(Resolve, FindsParametersHoweverTheirNumberIsWritten) {
  const auto p = profile();
  for (const auto* text : {"Xn0202", "xn202", "Xn_0202", "xn-202", "tuning_mode", "Tuning mode"})
    EXPECT_EQ(found(p, text), (ObjectAddress{0x2001, 3})) << text;
}

TEST(Resolve, OffersAllMeaningsOfAnAmbiguousName) {
  const auto p = profile();
  const auto target = resolve(&p, "homing_speeds");
  ASSERT_FALSE(target);
  EXPECT_EQ(target.error().message.text(), "'homing_speeds' is ambiguous: 2 meanings");
  EXPECT_EQ(
      target.error().hint.text(),
      "write homing_speeds.speed_during_search_for_switch or homing_speeds.speed_during_search_for_zero");
  EXPECT_FALSE(resolve(&p, "homing_speeds.search"));
}

TEST(Resolve, OffersTheNearestNameForAMisspeltOne) {
  const auto p = profile();
  EXPECT_EQ(resolve(&p, "statuswrod").error().hint.text(), "did you mean statusword?");
  EXPECT_EQ(resolve(&p, "Xn0203").error().hint.text(), "did you mean Xn0202 or Xn0009?");
}

TEST(Resolve, RefusesAParameterThatHasNoObject) {
  const auto p = profile();
  const auto target = resolve(&p, "Xn9");
  ASSERT_FALSE(target);
  EXPECT_EQ(target.error().message.text(), "Xn0009 Panel brightness has no CANopen object");
  EXPECT_TRUE(resolve_parameter(p, "Xn9"));
  EXPECT_EQ(resolve(&p, "panel brightness").error().message.text(), target.error().message.text())
      << "by its name too";
}

TEST(CanonicalId, IsTheSameForAllSpellingsAndOnlyForThem) {
  EXPECT_EQ(canonical_id("Pn0202"), canonical_id("pn202"));
  EXPECT_EQ(canonical_id("Fn_33"), canonical_id("fn33"));
  EXPECT_EQ(canonical_id("Fn_0A"), canonical_id("FnA"));
  EXPECT_EQ(canonical_id("P0.03"), canonical_id("p0.3"));
  EXPECT_EQ(canonical_id("PA-21"), canonical_id("pa21"));
  EXPECT_EQ(canonical_id("Pn0000"), canonical_id("Pn0"));
  EXPECT_NE(canonical_id("P3-5"), canonical_id("P35"));
  EXPECT_NE(canonical_id("Pn0200"), canonical_id("Pn0020"));
  EXPECT_NE(canonical_id("Pn1000"), canonical_id("Pn0100"));
}

TEST(Names, HoldEveryParameterAndEveryOtherEntryOnce) {
  EXPECT_EQ(names(profile()),
            (std::vector<std::string>{"Xn0202", "Xn0009", "gain.highest_sub_index_supported", "statusword",
                                      "homing_speeds.highest_sub_index_supported",
                                      "homing_speeds.speed_during_search_for_switch",
                                      "homing_speeds.speed_during_search_for_zero"}));
}

/// Every family that has Chinese names.
std::vector<Profile> families() {
  std::vector<Profile> out;
  for (const auto& family : find_families(kFolders))
    out.push_back(load_profile(family.name, kFolders).value());
  return out;
}

TEST(Resolve, TakesEveryChineseNameForItsOwnObjectOrForAmbiguous) {
  std::size_t own = 0;
  for (const auto& profile : families())
    for (const auto& object : profile.dictionary.objects())
      for (const auto& entry : object.entries) {
        if (entry.name_zh.empty() || parse_object_address(entry.name_zh)) continue;
        const auto target = resolve(&profile, entry.name_zh);
        if (!target) {
          EXPECT_NE(target.error().message.text().find("is ambiguous"), std::string::npos)
              << profile.family << " " << entry.name_zh << ": " << target.error().message.text();
          continue;
        }
        own += target->address == entry.address;
        const auto* there = profile.dictionary.find(target->address);
        EXPECT_TRUE(target->address == entry.address || there == nullptr || there->name_zh != entry.name_zh)
            << profile.family << " " << entry.name_zh << " is taken for " << to_string(target->address);
      }
  EXPECT_GT(own, 500U);
}

TEST(Resolve, NeverTakesANameWithChineseForAnEnglishOne) {
  const auto gsd600 = load_profile("gsd600", kFolders).value();
  EXPECT_EQ(resolve(&gsd600, "controlword")->address, (ObjectAddress{0x6040, 0}));
  for (const auto* text : {"速度controlword", "状态 statusword", "controlword字"}) {
    EXPECT_FALSE(resolve(&gsd600, text)) << text;
    EXPECT_FALSE(resolve_parameter(gsd600, text)) << text;
  }
}

TEST(Resolve, TakesNamesForChineseReadersThatHaveNoChinese) {
  const auto dm = load_profile("dm", kFolders).value();
  ASSERT_TRUE(resolve(&dm, "KT")) << resolve(&dm, "KT").error().message.text();
  EXPECT_EQ(dm.dictionary.find(resolve(&dm, "KT")->address)->name_zh, "KT");
}

TEST(Resolve, OffersTheNearestChineseNames) {
  const auto gsd600 = load_profile("gsd600", kFolders).value();
  const auto near = resolve(&gsd600, "速度环增益");
  ASSERT_FALSE(near);
  EXPECT_EQ(near.error().hint.text().find("did you mean 速度环增益 1"), 0U) << near.error().hint.text();
  const auto parameter = resolve_parameter(gsd600, "速度环增益");
  ASSERT_FALSE(parameter);
  EXPECT_EQ(parameter.error().hint.text().find("did you mean 速度环增益 1"), 0U)
      << parameter.error().hint.text();
}

}  // namespace
}  // namespace servoctl::drive
