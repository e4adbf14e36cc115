#include "drive/toml_depth.hpp"

#include <gtest/gtest.h>

#include <string>

namespace servoctl::drive {
namespace {

std::string repeated(std::size_t times, std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < times; ++i) out += text;
  return out;
}

bool is_flat(const std::string& toml) { return check_toml_depth(toml, "a.toml").has_value(); }

TEST(TomlDepth, WhatStandsInCommentsNestsNothing) {
  EXPECT_TRUE(is_flat(repeated(100, "a = 1  # range [0, 100)\n")));
  EXPECT_TRUE(is_flat("# " + repeated(1000, "a.") + "\nb = [1]\n"));
}

TEST(TomlDepth, WhatStandsInStringsNestsNothing) {
  EXPECT_TRUE(is_flat(repeated(100, "a = \"[0, 100)\"\n")));
  EXPECT_TRUE(is_flat(repeated(100, "a = '{'\n")));
  EXPECT_TRUE(is_flat(R"(a = "\"[[[")" + repeated(100, "\nb = \"\\\\\" # [")));
  EXPECT_TRUE(is_flat("a = \"\"\"" + repeated(100, "[\n\"\"'''") + "\"\"\"\n"));
  EXPECT_TRUE(is_flat("a = '''" + repeated(100, "[\n'\"\"\"\\") + "'''\n"));
  EXPECT_TRUE(is_flat("a = \"" + repeated(100, "x.y.") + "\"\n"));
}

TEST(TomlDepth, IsRefusedWithItsLine) {
  const auto deep = check_toml_depth("a = 1\nb = [ # {{{\n" + repeated(65, "["), "a.toml");
  ASSERT_FALSE(deep);
  EXPECT_EQ(deep.error().message.text(), "a.toml:3: tables are nested deeper than 64 levels");
  EXPECT_FALSE(is_flat(repeated(66, "a.") + "b = 1"));
  EXPECT_FALSE(is_flat(repeated(66, "\"a\" . 'b'.") + "c = 1"));
}

/// As toml++ reads them: the end of a string is found where it ends, and not later.
TEST(TomlDepth, WhatFollowsAStringCounts) {
  const auto deep = repeated(100, "[");
  for (const auto* before :
       {"a = [\"\", ", "a = ['', ", "a = [\"\"\"x\"\"\"\"\", ", "a = ['''x'''', ", "a = [\"\"\"\"\"\", ",
        "a = [\"\\\\\", ", "a = ['\\', ", "a = \"not ended\n", "# comment\na = ", "a = [\"\"\"\\\"\"\"\", "})
    EXPECT_FALSE(is_flat(before + deep)) << before;
}

}  // namespace
}  // namespace servoctl::drive
