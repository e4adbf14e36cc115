// A word too many that may be meant as an axis: why it is none.
#include "cli/axis_word.hpp"

#include <gtest/gtest.h>

namespace servoctl::cli {
namespace {

std::string hint(const std::vector<std::string>& words, const Result<const cabinet::Cabinet*>& known) {
  const auto parsed = parse_line(words);
  EXPECT_FALSE(parsed);
  return about_axis(parsed.error(), words, match_command(words), [&] { return known; }).hint.text();
}

TEST(AxisWord, TellsWhatIsWrongWithTheCabinetFile) {
  const Result<const cabinet::Cabinet*> broken = fail(Errc::file, "cabinet.toml:3:1: unknown key 'nod'");
  for (const auto& line : {std::vector<std::string>{"status", "feeder"}, {"jog", "feeder", "60rpm"}})
    EXPECT_NE(hint(line, broken)
                  .find("'feeder' may be an axis, but the cabinet file cannot be used: "
                        "cabinet.toml:3:1: unknown key 'nod'"),
              std::string::npos)
        << hint(line, broken);
}

TEST(AxisWord, TellsWhichAxesThereAre) {
  cabinet::Cabinet cabinet;
  cabinet.file = "cabinet.toml";
  cabinet.axes.resize(2);
  cabinet.axes[0].name = "feeder";
  cabinet.axes[1].name = "lift";
  const Result<const cabinet::Cabinet*> known = &cabinet;
  EXPECT_TRUE(
      hint({"status", "foo"}, known).starts_with("cabinet.toml has no axis 'foo'; its axes: feeder or lift"))
      << hint({"status", "foo"}, known);
}

TEST(AxisWord, TellsThatThereIsNoCabinetFile) {
  const Result<const cabinet::Cabinet*> none = nullptr;
  EXPECT_TRUE(
      hint({"status", "foo"}, none).starts_with("nodes are named by -n; there is no cabinet file here"))
      << hint({"status", "foo"}, none);
  EXPECT_EQ(hint({"objects", "a", "b"}, none), "`help objects` shows how it is used");
}

}  // namespace
}  // namespace servoctl::cli
