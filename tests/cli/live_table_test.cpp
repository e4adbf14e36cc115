#include "cli/terminal/live_table.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <string>

#include "base/text.hpp"

namespace servoctl::cli {
namespace {

using show::LiveView;

LiveTable watched_values() {
  return LiveTable(LiveView::Layout{
      .columns = {{.title = "node", .right = true}, {.title = "object"}, {.title = "value"}}});
}

LiveTable with_rows(int count) {
  auto table = watched_values();
  for (int i = 1; i <= count; ++i)
    table.set(fmt::format("{}", i),
              {fmt::format("{}", i), "Position actual value", fmt::format("{} inc", 100 - i)}, 100 - i);
  table.update();
  return table;
}

TEST(Sparkline, RisesFromTheLeastToTheLargestOfTheLastValues) {
  EXPECT_EQ(sparkline({0, 1, 2, 3, 4, 5, 6, 7}, 8), "▁▂▃▄▅▆▇█");
  EXPECT_EQ(sparkline({100, 0, 7}, 2), "▁█") << "what is no longer shown does not count";
  EXPECT_EQ(sparkline({5, 5, 5}, 8), "▅▅▅") << "what stands still is in the middle";
  EXPECT_EQ(sparkline({}, 8), "");
  EXPECT_EQ(sparkline({1}, 0), "");
}

TEST(LiveTable, HasARowForEachKeyInTheOrderTheyCame) {
  auto table = with_rows(2);
  table.set("1", {"1", "Position actual value", "12 inc"}, 12);
  table.update();
  const auto lines = table.lines(80, 24);
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0], " node  object                 value");
  EXPECT_EQ(lines[1], "    1  Position actual value  12 inc  █▁");
  EXPECT_EQ(lines[2], "    2  Position actual value  98 inc  ▅");
  EXPECT_EQ(lines[3], "space: pause  s: sort  q: quit");
}

TEST(LiveTable, FitsScreensOfEverySize) {
  for (const int rows : {0, 1, 5, 40})
    for (std::size_t width = 1; width < 130; width += 3)
      for (std::size_t height = 1; height < 60; height += 7) {
        auto table = with_rows(rows);
        table.remark("node 3: heartbeat lost");
        const auto lines = table.lines(width, height);
        EXPECT_LE(lines.size(), height);
        for (const auto& line : lines) EXPECT_LE(display_width(line), width) << line;
      }
}

TEST(LiveTable, ScrollsWhatDoesNotFit) {
  auto table = with_rows(40);
  auto lines = table.lines(80, 12);
  ASSERT_EQ(lines.size(), 12U);
  EXPECT_EQ(lines[1].substr(0, 5), "    1");
  EXPECT_EQ(lines.back(), "space: pause  s: sort  q: quit  up, down: rows 1 to 10 of 40");
  table.scroll(-1);
  table.scroll(2);
  EXPECT_EQ(table.lines(80, 12)[1].substr(0, 5), "    3");
  table.scroll(100);
  lines = table.lines(80, 12);
  EXPECT_EQ(lines[10].substr(0, 5), "   40") << "the last row stays the last line";
  EXPECT_EQ(lines.back(), "space: pause  s: sort  q: quit  up, down: rows 31 to 40 of 40");
}

TEST(LiveTable, SortsByOneColumnAfterTheOther) {
  auto table = watched_values();
  table.set("a", {"10", "Statusword", "0x0237"}, {});
  table.set("b", {"9", "Velocity", "-"}, {});
  table.set("c", {"2", "Position", "7 inc"}, {});
  table.update();
  const auto nodes = [&] {
    std::string out;
    const auto lines = table.lines(80, 24);
    for (std::size_t i = 1; i < 4; ++i) out += std::string(trim(lines[i].substr(0, 5))) + " ";
    return out + lines[0].substr(0, lines[0].find_last_not_of(' ') + 1);
  };
  EXPECT_EQ(nodes(), "10 9 2  node  object      value");
  table.sort_by_next();
  EXPECT_EQ(nodes(), "2 9 10 node*  object      value") << "numbers by their size";
  table.sort_by_next();
  EXPECT_EQ(nodes(), "2 10 9  node  object*     value");
  table.sort_by_next();
  EXPECT_EQ(nodes(), "10 2 9  node  object      value*");
  table.sort_by_next();
  EXPECT_EQ(nodes(), "10 9 2  node  object      value");
}

TEST(LiveTable, ShowsNothingNewWhileItIsPaused) {
  auto table = with_rows(1);
  table.pause();
  table.set("1", {"1", "Position actual value", "7 inc"}, 7);
  table.set("2", {"2", "Position actual value", "8 inc"}, 8);
  table.update();
  auto lines = table.lines(80, 24);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_NE(lines[1].find("99 inc"), std::string::npos) << lines[1];
  EXPECT_EQ(lines[2], "PAUSED  space: pause  s: sort  q: quit");
  table.pause();
  table.update();
  lines = table.lines(80, 24);
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_NE(lines[1].find("7 inc"), std::string::npos) << lines[1];
}

TEST(LiveTable, WhatDrivesSayMovesNoCursor) {
  auto table = watched_values();
  table.set("1", {"1", "name\x1B[2J", "a\nb"}, {});
  table.update();
  EXPECT_EQ(table.lines(80, 24)[1], "    1  name\\x1B[2J  a\\nb");
}

}  // namespace
}  // namespace servoctl::cli
