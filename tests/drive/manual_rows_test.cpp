// How many rows of each section of the manuals stand in the tables. The numbers are those of the manuals' own
// tables.
#include <gtest/gtest.h>

#include <filesystem>
#include <ios>
#include <set>

#include "base/number.hpp"
#include "drive/naming.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::drive {
namespace {

Profile load(std::string_view family) {
  auto profile = load_profile(family, kFolders);
  EXPECT_TRUE(profile) << profile.error().message.text();
  return profile ? std::move(*profile) : Profile{};
}

struct Lines {
  std::uint32_t first;
  std::uint32_t last;
  std::size_t rows;
};

template <class Rows>
void expect_rows(const Rows& rows, std::initializer_list<Lines> sections) {
  std::size_t told = 0;
  for (const auto& section : sections) {
    std::size_t count = 0;
    for (const auto& row : rows) count += row.line >= section.first && row.line <= section.last ? 1 : 0;
    EXPECT_EQ(count, section.rows) << "lines " << section.first << " to " << section.last;
    told += section.rows;
  }
  EXPECT_EQ(rows.size(), told);
}

std::vector<od::Entry> entries(const Profile& profile) {
  std::vector<od::Entry> out;
  for (const auto& object : profile.dictionary.objects())
    out.insert(out.end(), object.entries.begin(), object.entries.end());
  return out;
}

TEST(ManualRows, OfTheGsd600StandByChapter) {
  const auto profile = load("gsd600");
  // Rows of the overview tables 4.3.1 to 4.3.7: lines 1764, 2057, 2712, 3203, 3801, 4393 and 5123 ff.
  const std::pair<unsigned, std::size_t> chapters[] = {{0, 25},   {100, 57}, {200, 43}, {300, 52},
                                                       {400, 51}, {600, 83}, {1000, 20}};
  for (std::size_t i = 0; i < std::size(chapters); ++i) {
    const unsigned first = chapters[i].first;
    const unsigned last = i + 1 < std::size(chapters) ? chapters[i + 1].first : 2000;
    std::size_t count = 0;
    for (const auto& p : profile.parameters) {
      const auto number = parse_digits(std::string_view(p.id).substr(2), 10).value_or(0);
      count += number >= first && number < last ? 1 : 0;
    }
    EXPECT_EQ(count, chapters[i].second) << "from Pn" << first;
  }
  EXPECT_EQ(profile.parameters.size(), 331U);
}

std::size_t objects_between(const Profile& profile, unsigned first, unsigned last) {
  std::size_t count = 0;
  for (const auto& object : profile.dictionary.objects())
    count += object.index >= first && object.index <= last ? 1 : 0;
  return count;
}

std::size_t parameters_called(const Profile& profile, std::string_view prefix) {
  std::size_t count = 0;
  for (const auto& p : profile.parameters) count += p.id.starts_with(prefix) ? 1U : 0U;
  return count;
}

TEST(ManualRows, OfTheDa200StandBySection) {
  const auto profile = load("da200");
  EXPECT_EQ(objects_between(profile, 0x1000, 0x13FF), 6U);   // 752-759
  EXPECT_EQ(objects_between(profile, 0x1400, 0x1BFF), 16U);  // 760-763, four of each kind
  EXPECT_EQ(objects_between(profile, 0x6000, 0x67FF), 55U);  // 767-825
  EXPECT_EQ(parameters_called(profile, "P"), 18U);
  EXPECT_EQ(parameters_called(profile, "R"), 1U);
  expect_rows(profile.faults, {{1104, 1150, 47}, {1153, 1177, 25}});
  std::size_t with_remedy = 0;
  for (const auto& fault : profile.faults)
    with_remedy +=
        !fault.check_zh.empty() && !fault.doubts.about("check") && fault.doubts.contradicted.empty();
  EXPECT_EQ(with_remedy, 17U);  // 1083-1099
}

TEST(ManualRows, OfTheDmStandBySection) {
  const auto profile = load("dm");
  expect_rows(entries(profile), {{408, 587, 52},
                                 {588, 669, 16},
                                 {670, 721, 36},
                                 {722, 873, 24},
                                 {874, 898, 36},
                                 {899, 984, 44},
                                 {985, 1115, 26},
                                 {325, 330, 4}});
  EXPECT_EQ(profile.faults.size(), 2U);  // 450, 635
}

TEST(ManualRows, OfTheTsStandBySection) {
  const auto profile = load("ts");
  EXPECT_EQ(parameters_called(profile, "Fn_"), 317U);
  EXPECT_EQ(parameters_called(profile, "Dn_"), 5U);
  std::size_t in_paths = 0;
  for (const auto& p : profile.parameters) {
    const auto number = profile.rules.numbering[0].number(p.id);
    in_paths += number && *number >= 0x100 && *number <= 0x1FF ? 1U : 0U;
  }
  EXPECT_EQ(in_paths, 256U);  // 32 paths of 8
  const auto methods = target_at(&profile, {0x6098, 0}).entry->labels.size();
  EXPECT_EQ(methods, 13U);  // 2185-2203
  expect_rows(profile.faults, {{2211, 2254, 22}, {2261, 2265, 3}});
}

TEST(ManualRows, OfTheSv2StandBySection) {
  const auto profile = load("sv2");
  EXPECT_EQ(objects_between(profile, 0x2000, 0x2008), 9U);
  std::size_t printed = 0;
  for (const auto& entry : entries(profile))
    printed +=
        entry.address.index >= 0x2000 && entry.address.index <= 0x2008 && entry.address.sub != 0 ? 1 : 0;
  EXPECT_EQ(printed, 47U);                            // 550-609
  EXPECT_EQ(parameters_called(profile, "PA-"), 88U);  // 664-820
  EXPECT_EQ(parameters_called(profile, "P3-"), 29U);  // 822-852
  std::set<std::string> alarms;
  for (const auto& fault : profile.faults) alarms.insert(fault.panel);
  EXPECT_EQ(alarms.size(), 44U);  // 1395-1439; Err-62 has two codes
  EXPECT_EQ(profile.faults.size(), 45U);
}

/// Bits of the mapped objects of a fixed PDO.
unsigned mapped_bytes(const Profile& profile, std::uint16_t index) {
  unsigned bits = 0;
  for (const auto& entry : profile.dictionary.object(index)->entries)
    if (entry.address.sub != 0 && entry.default_value)
      bits += static_cast<unsigned>(od::to_double(entry.default_value->value)) & 0xFFU;
  return bits / 8;
}

TEST(ManualRows, OfTheSv2MapAsManyBytesAsItsSyncManagersCarry) {
  const auto profile = load("sv2");
  // 530 and 545.
  const std::pair<std::uint16_t, unsigned> lengths[] = {{0x1701, 12}, {0x1702, 19}, {0x1703, 17},
                                                        {0x1704, 23}, {0x1705, 19}, {0x1B01, 28},
                                                        {0x1B02, 25}, {0x1B03, 29}, {0x1B04, 29}};
  for (const auto& [index, bytes] : lengths)
    EXPECT_EQ(mapped_bytes(profile, index), bytes) << std::hex << index;
}

}  // namespace
}  // namespace servoctl::drive
