// Commands in hints carry the place of the line that they answer.
#include "cli/hint_place.hpp"

#include <gtest/gtest.h>

namespace servoctl::cli {
namespace {

std::string placed(const std::string& text, const std::vector<std::string>& line) {
  const auto parsed = parse_line(line);
  EXPECT_TRUE(parsed) << parsed.error().message;
  return parsed ? with_place(text, *parsed) : std::string();
}

TEST(HintPlace, IsThatOfTheLineAsFarAsTheCommandNeedsIt) {
  const std::vector<std::string> line{"status", "-n", "9", "-d", "dm", "-b", "sim:dm@1"};
  EXPECT_EQ(placed("`scan` shows who is there", line), "`scan -b sim:dm@1` shows who is there");
  EXPECT_EQ(placed("`nmt preop -n 9`; `objects 0x6060` lists them", line),
            "`nmt preop -n 9 -b sim:dm@1`; `objects 0x6060 -d dm` lists them");
  EXPECT_EQ(placed("`disable` it", line), "`disable -n 9 -b sim:dm@1` it");
  EXPECT_EQ(placed("`param list` shows all", line), "`param list -d dm` shows all");
}

TEST(HintPlace, IsLeftToThePromptAndTheEnvironmentWhereTheLineDoesNotSayIt) {
  EXPECT_EQ(placed("`scan` shows who is there", {"status"}), "`scan` shows who is there");
  EXPECT_EQ(placed("`status` and `objects`", {"status", "-n", "1"}), "`status -n 1` and `objects`");
}

TEST(HintPlace, IsNotPutIntoWhatIsNoWholeCommand) {
  const std::vector<std::string> line{"status", "-n", "9", "-b", "sim:dm@1"};
  for (const auto* text : {"`param set`", "`param set … --keep`", "`help status`", "`--turn`",
                           "`pdo map 1 OBJECT…`", "an open ` quote"})
    EXPECT_EQ(placed(text, line), text);
}

TEST(HintPlace, QuotesWhatAShellWouldTakeApart) {
  EXPECT_EQ(placed("`scan`", {"status", "-n", "1", "-b", "sim:dm@1?fault=0xFF00@1s&silent=2s"}),
            "`scan -b 'sim:dm@1?fault=0xFF00@1s&silent=2s'`");
}

}  // namespace
}  // namespace servoctl::cli
