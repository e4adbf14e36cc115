#include "od/dictionary.hpp"

#include <gtest/gtest.h>

namespace servoctl::od {
namespace {

TEST(Identifier, KeepsLettersAndDigits) {
  EXPECT_EQ(identifier("Position actual value"), "position_actual_value");
  EXPECT_EQ(identifier(" COB-ID used by RPDO (1) "), "cob_id_used_by_rpdo_1");
  EXPECT_EQ(identifier("—"), "");
  EXPECT_EQ(identifier("@AZaz09[`{/:"), "azaz09");
}

TEST(Dictionary, FindsWhatWasAddedInAnyOrder) {
  Dictionary d;
  for (const auto index : std::initializer_list<std::uint16_t>{0x3000, 0x1000, 0x2000}) {
    Entry entry;
    entry.address = {index, 0};
    d.add({index, "o", ObjectCode::var, {entry}});
  }
  EXPECT_EQ(d.objects().front().index, 0x1000);
  for (const auto index : std::initializer_list<std::uint16_t>{0x1000, 0x2000, 0x3000})
    EXPECT_NE(d.find({index, 0}), nullptr);
  EXPECT_EQ(d.find({0x2000, 1}), nullptr);
  EXPECT_EQ(d.object(0x2001), nullptr);
  d.add({0x2000, "again", ObjectCode::var, {}});
  EXPECT_EQ(d.objects().size(), 3U);
  EXPECT_EQ(d.object(0x2000)->name, "again");
}

TEST(Dictionary, CountsEntriesAndGivesThemToBeChanged) {
  Dictionary d;
  EXPECT_TRUE(d.empty());
  EXPECT_EQ(d.entry_count(), 0U);
  Entry first;
  first.address = {0x2000, 1};
  Entry second;
  second.address = {0x2000, 4};
  d.add({0x2000, "o", ObjectCode::array, {first, second}});
  EXPECT_FALSE(d.empty());
  EXPECT_EQ(d.entry_count(), 2U);
  d.find({0x2000, 4})->name = "changed";
  EXPECT_EQ(d.object(0x2000)->entries[1].name, "changed");
  EXPECT_EQ(d.find({0x2001, 4}), nullptr);
  EXPECT_EQ(d.object(0x1FFF), nullptr);
}

TEST(Access, HasNamesAndSaysWhatIsAllowed) {
  struct Row {
    Access access;
    const char* name;
    bool readable;
    bool writable;
  };
  for (const auto& row : {Row{Access::ro, "ro", true, false}, Row{Access::rw, "rw", true, true},
                          Row{Access::wo, "wo", false, true}, Row{Access::constant, "const", true, false}}) {
    EXPECT_EQ(name(row.access), row.name);
    EXPECT_EQ(readable(row.access), row.readable) << row.name;
    EXPECT_EQ(writable(row.access), row.writable) << row.name;
  }
}

TEST(PdoMapping, HasNames) {
  EXPECT_EQ(name(PdoMapping::no), "no");
  EXPECT_EQ(name(PdoMapping::rpdo), "rpdo");
  EXPECT_EQ(name(PdoMapping::tpdo), "tpdo");
  EXPECT_EQ(name(PdoMapping::both), "both");
}

TEST(Effect, HasNamesThatGoBothWays) {
  for (const auto effect : {Effect::unstated, Effect::immediate, Effect::restart, Effect::standstill})
    EXPECT_EQ(parse_effect(name(effect)), effect);
  EXPECT_EQ(name(Effect::standstill), "standstill");
  EXPECT_EQ(parse_effect("soon"), std::nullopt);
}

TEST(NodeValue, AddsTheNodeIdToNumbersOnly) {
  EXPECT_EQ(NodeValue({Value(std::uint64_t{7}), true}).for_node(5), Value(std::uint64_t{12}));
  EXPECT_EQ(NodeValue({Value(std::int64_t{-7}), true}).for_node(5), Value(std::int64_t{-2}));
  EXPECT_EQ(NodeValue({Value(std::uint64_t{7}), false}).for_node(5), Value(std::uint64_t{7}));
  EXPECT_EQ(NodeValue({Value(std::string("a")), true}).for_node(5), Value(std::string("a")));
}

}  // namespace
}  // namespace servoctl::od
