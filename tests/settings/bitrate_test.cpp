#include "drive/bitrate.hpp"

#include <gtest/gtest.h>

#include "tests/settings/address_world.hpp"

namespace servoctl::settings {
namespace {

TEST(Bitrate, IsReadAsPeopleWriteIt) {
  for (const auto* text : {"500k", "500 kbit/s", "500000", "0.5M", "500 kbps"})
    EXPECT_EQ(drive::parse_bitrate(text).value_or(0), 500'000U) << text;
  EXPECT_EQ(drive::parse_bitrate("1M").value_or(0), 1'000'000U);
  for (const auto* text : {"", "fast", "0", "2M", "-500k", "5k", "500x", "nan", "inf", "1e9", "k"})
    EXPECT_FALSE(drive::parse_bitrate(text)) << text;
}

TEST(Bitrate, HasTheCodesOfTheManuals) {
  struct Row {
    const char* family;
    std::uint32_t bitrate;
    std::optional<std::int64_t> code;
  };
  const Row rows[] = {{"gsd600", 1'000'000, 8}, {"gsd600", 10'000, 0},   {"gsd600", 800'000, 7},
                      {"da200", 1'000'000, 0},  {"da200", 20'000, 5},    {"da200", 800'000, {}},
                      {"ts", 500'000, 500},     {"ts", 1'000'000, 1000}, {"ts", 50'000, {}},
                      {"ts", 333'000, {}},      {"dm", 500'000, {}},     {"cia402", 500'000, {}},
                      {"gsd600", 333'000, {}}};
  for (const auto& row : rows) {
    const auto profile = drive::load_profile(row.family, kFolders).value();
    const auto code = drive::bitrate_code(profile, row.bitrate);
    EXPECT_EQ(code ? std::optional(*code) : std::nullopt, row.code) << row.family << " " << row.bitrate;
  }
}

}  // namespace
}  // namespace servoctl::settings
