// Commands in hints carry the place of the line that they answer.
#include "cli/hint_place.hpp"

#include <gtest/gtest.h>

#include "report/value.hpp"
#include "traffic/finding.hpp"

namespace servoctl::cli {
namespace {

std::string placed(const std::string& text, const std::vector<std::string>& line) {
  const auto parsed = parse_line(line);
  EXPECT_TRUE(parsed) << parsed.error().message.text();
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

TEST(HintPlace, LeavesTheFamilyOfAnotherNodeToTheReader) {
  const std::vector<std::string> line{"heartbeat", "show", "-n", "3", "-d", "ts"};
  EXPECT_EQ(placed("`watchdog -n 5`", line), "`watchdog -n 5 -d FAMILY`");
  EXPECT_EQ(placed("`watchdog -n 3`", line), "`watchdog -n 3 -d ts`");
  const std::vector<std::string> several{"heartbeat", "show", "-n", "1-4", "-d", "ts"};
  EXPECT_EQ(placed("`watchdog -n 3`", several), "`watchdog -n 3 -d ts`");
  EXPECT_EQ(placed("`heartbeat set 100ms -n 5`", line), "`heartbeat set 100ms -n 5`") << "needs none";
  const std::vector<std::string> all{"heartbeat", "show", "-n", "all", "-d", "ts"};
  EXPECT_EQ(placed("`watchdog -n 3`", all), "`watchdog -n 3 -d ts`");
}

TEST(HintPlace, GivesACommandOfTheSameKindTheNodeOfTheLine) {
  EXPECT_EQ(placed("`address 5`", {"address", "-n", "3", "-d", "ts"}), "`address 5 -n 3 -d ts`");
}

TEST(HintPlace, IsThatOfTheFindingInWhatMendsIt) {
  const auto findings = [](const std::string& bus, const std::string& mend) {
    Outcome out;
    out.result = traffic::findings_value(
        {{bus, {{traffic::Finding::Level::fault, "code", "what is so", "what it means", mend}}}});
    return out;
  };
  const auto mended = [&](const std::string& bus, const std::string& mend, std::vector<std::string> line) {
    const auto parsed = parse_line(line);
    const auto out = with_place(findings(bus, mend), parsed.value());
    const auto& table = *out.result.table();
    const auto json = report::to_json(table.documents.front());
    const auto shown = std::get<std::string>(table.rows.back().back().data()).substr(8);
    EXPECT_NE(json.find("\"mend\":\"" + shown + "\""), std::string::npos) << json;
    return shown;
  };
  EXPECT_EQ(mended("slcan:/dev/ttyACM0@500k", "`doctor --active` asks them",
                   {"doctor", "-b", "slcan:/dev/ttyACM0@500k"}),
            "`doctor --active -b slcan:/dev/ttyACM0@500k` asks them");
  EXPECT_EQ(mended("can0", "`address NEW -n 5`; `help lss set-node`", {"doctor", "can0"}),
            "`address NEW -n 5 -b can0`; `help lss set-node`");
  EXPECT_EQ(mended("can1", "`doctor can1 --active`, `bus up can1`", {"doctor"}),
            "`doctor can1 --active`, `bus up can1`");
  EXPECT_EQ(mended("", "`scan -b slcan:/dev/ttyACM0@500k`", {"doctor"}), "`scan -b slcan:/dev/ttyACM0@500k`");
}

}  // namespace
}  // namespace servoctl::cli
