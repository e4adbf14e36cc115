#include "report/value.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/text.hpp"

namespace servoctl::report {
namespace {

using namespace std::string_literals;

Table table() {
  Table t;
  t.columns = {{"index", "", Show::text}, {"name"}, {"raw", "", Show::json}, {"value"}};
  t.rows = {{Hex{0x6040, 4}, "Controlword", 6, 6}, {Hex{0x607A, 4}, "目标位置", -20, Value()}};
  return t;
}

TEST(Text, AlignsTablesAndLeavesJsonColumnsOut) {
  EXPECT_EQ(to_text(table()),
            "index   name         value\n0x6040  Controlword      6\n0x607A  目标位置         -\n");
}

TEST(Text, IsAlignedByWhatIsShownOfHostileCellsAndHeadings) {
  Table t;
  t.columns = {{"name"}, {"a\x1B[2J"}};
  t.rows = {{"x\u202Ey", 1}, {"z", 2}};
  EXPECT_EQ(to_text(t), "name      a\\x1B[2J\nx\\u202Ey         1\nz                2\n");
  EXPECT_EQ(to_text(Record{{"k\x9B", "v\n\x07"}}), "k\\x9B  v\\n\\x07\n");
  EXPECT_EQ(to_text(Value("two\nlines\x1B[2J")), "two\nlines\\x1B[2J\n");
}

TEST(Json, KeepsNumbersNumbersAndTheOrderOfFields) {
  EXPECT_EQ(to_json(table()),
            R"([{"name":"Controlword","raw":6,"value":6},{"name":"目标位置","raw":-20,"value":null}])");
  EXPECT_EQ(to_json(Record{{"b", 1}, {"a", true}, {"h", Hex{0x6041, 4}}, {"t", "x"s, Show::text}}),
            R"({"b":1,"a":true,"h":24641})");
}

TEST(Text, BreaksTheCellsOfTheWidestColumnToFitTheTerminal) {
  Table t;
  t.columns = {{"id"}, {"result"}, {"note"}};
  t.rows = {{1, "written, read back", std::string(60, 'x')}, {2, "", "位置环增益位置环增益位置环增益"}};
  EXPECT_EQ(to_text(t, 40),
            "id  result             note\n"
            " 1  written, read      xxxxxxxxxxxxxxxxx\n"
            "    back               xxxxxxxxxxxxxxxxx\n"
            "                       xxxxxxxxxxxxxxxxx\n"
            "                       xxxxxxxxx\n"
            " 2                     位置环增益位置环\n"
            "                       增益位置环增益\n");
  EXPECT_EQ(to_text(t, 34),
            "id  result          note\n"
            " 1  written, read   xxxxxxxxxxxxxx\n"
            "    back            xxxxxxxxxxxxxx\n"
            "                    xxxxxxxxxxxxxx\n"
            "                    xxxxxxxxxxxxx…\n"
            " 2                  位置环增益位置\n"
            "                    环增益位置环增\n"
            "                    益\n");
  EXPECT_EQ(to_text(t).find("…"), std::string::npos);
}

TEST(Text, WideColumnsShareWhatIsTooMuch) {
  Table t;
  t.columns = {{"a"}, {"b"}, {"c"}, {"d"}};
  t.rows = {{1, "123456789", std::string(60, 'x'), std::string(59, 'y')}};
  const auto text = to_text(t, 81);
  EXPECT_NE(text.find("\n1  123456789  " + std::string(33, 'x') + "  " + std::string(32, 'y') + "\n"),
            std::string::npos)
      << text;
  t.rows = {{1, "123456789", std::string(15, 'x'), std::string(90, 'y')}};
  EXPECT_NE(to_text(t, 60).find(std::string(15, 'x') + "  " + std::string(29, 'y') + "\n"),
            std::string::npos);
}

TEST(Text, BreaksACellOfAnyLengthAtOnce) {
  Table t;
  t.columns = {{"name"}};
  const auto begun = std::chrono::steady_clock::now();
  for (const std::string unit : {"x", "x ", "\xCC\x81"}) {
    std::string cell = std::string(30, 'w');
    for (int i = 0; i < 200000; ++i) cell += unit;
    t.rows = {{cell}};
    const auto text = to_text(t, 20);
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), unit[0] == 'x' ? 5 : 3) << unit;
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(5));
}

TEST(Text, LeavesOutColumnsThatAreEmptyThroughout) {
  Table t;
  t.columns = {{"a"}, {"b"}, {"c"}};
  t.rows = {{1, Value(), ""}, {2, Value(), ""}};
  EXPECT_EQ(to_text(t), "a\n1\n2\n");
  EXPECT_EQ(to_json(t), R"([{"a":1,"b":null,"c":""},{"a":2,"b":null,"c":""}])");
  t.json_only = true;
  EXPECT_EQ(to_text(t), "");
}

TEST(Text, ShowsRecordsWithTheirBlocksBelow) {
  const Record r{{"name", "Gain"},
                 {"enum", Record{{"0", "Off"}, {"1", "On"}}},
                 {"empty", Value()},
                 {"modes", List{"pp", "pv"}},
                 {"ok", false}};
  EXPECT_EQ(to_text(r), "name   Gain\nmodes  pp, pv\nok     no\n\nenum:\n0  Off\n1  On\n");
}

TEST(Text, BreaksLongFieldsAtBlanks) {
  EXPECT_EQ(to_text(Record{{"note", "one two three four"}}, 16), "note  one two\n      three four\n");
}

TEST(Text, LetsNoControlCharacterOfADriveThrough) {
  Table t;
  t.columns = {{"name"}};
  t.rows = {{"a\x1B[2J\nb"}};
  EXPECT_EQ(to_text(t), "name\na\\x1B[2J\\nb\n");
}

TEST(Json, MendsBytesThatAreNoUtf8) { EXPECT_EQ(to_json(Value("a\xFF"s)), "\"a\xEF\xBF\xBD\""); }

TEST(Json, WritesWholeDoublesWithoutAPoint) {
  EXPECT_EQ(to_json(Value(40.0)), "40");
  EXPECT_EQ(to_json(Value(0.1)), "0.1");
  EXPECT_EQ(to_json(Value(std::uint64_t{18446744073709551615U})), "18446744073709551615");
}

TEST(Text, OfNothingIsNothing) {
  EXPECT_EQ(to_text(Value()), "");
  EXPECT_EQ(to_text(Value("x")), "x\n");
}

TEST(Text, PlotsQuantitiesOverTime) {
  const Record r{{"node", 1}, {"samples", Plot{{{"velocity", "rpm", {0, 1}, {0, 60}}}}}};
  const auto text = to_text(r, 200);
  EXPECT_TRUE(text.starts_with("node  1\n\nsamples:\nvelocity (rpm)\n60 ┤")) << text;
  for (const auto line : split(std::string_view(text), '\n')) EXPECT_LE(display_width(line), 80U);
}

TEST(Json, CarriesTheSamplesOfAPlotBothWays) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Plot plot{{{"velocity", "rpm", {0, 0.5, 1}, {0, 59.5, nan}}, {"mode", "", {}, {}}}};
  const auto json = to_json(plot);
  EXPECT_EQ(json, R"([{"name":"velocity","unit":"rpm","seconds":[0,0.5,1],"values":[0,59.5,null]},)"
                  R"({"name":"mode","unit":null,"seconds":[],"values":[]}])");
  const auto read = plot_of(*parse_json(json, "test"));
  ASSERT_TRUE(read.has_value());
  ASSERT_EQ(read->series.size(), 2U);
  EXPECT_EQ(read->series[0].name, "velocity");
  EXPECT_EQ(read->series[0].unit, "rpm");
  EXPECT_EQ(read->series[0].seconds, (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(read->series[0].values[1], 59.5);
  EXPECT_TRUE(std::isnan(read->series[0].values[2]));
  EXPECT_EQ(read->series[1].unit, "");
}

TEST(Json, IsNoPlotWhereSecondsAndValuesDoNotFit) {
  for (const auto* text :
       {"7", "[7]", R"([{"seconds":[1],"values":[]}])", R"([{"seconds":["1"],"values":[1]}])"}) {
    const auto read = plot_of(*parse_json(text, "test"));
    ASSERT_FALSE(read.has_value()) << text;
    EXPECT_EQ(read.error().code, Errc::file);
  }
}

}  // namespace
}  // namespace servoctl::report
