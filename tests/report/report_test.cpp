#include "report/value.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "base/text.hpp"
#include "report/table_text.hpp"

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
            "                    xxxxxxxxxxxxxx\n"
            "                    xxxx\n"
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

/// Time of this thread's own, whatever else the machine does, that a cell of so many bytes takes.
double seconds_for_cell(const std::string& unit, std::size_t bytes) {
  const auto used = [] {
    timespec out{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &out);
    return static_cast<double>(out.tv_sec) + static_cast<double>(out.tv_nsec) * 1e-9;
  };
  Table t;
  t.columns = {{"name"}};
  std::string cell(30, 'w');
  while (cell.size() < bytes) cell += unit;
  t.rows = {{cell}};
  const auto begun = used();
  const auto text = to_text(t, 20);
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 13) << unit;
  return used() - begun;
}

TEST(Text, BreaksACellOfAnyLengthAtOnce) {
  for (const std::string unit : {"x", "x ", "\xCC\x81"}) {
    double few = 1;
    double many = 1;
    for (int i = 0; i < 2; ++i) {
      few = std::min(few, seconds_for_cell(unit, 10'000));
      many = std::min(many, seconds_for_cell(unit, 200'000));
    }
    // Twenty times as much takes twenty times as long; what looks at all of it again and again takes 400
    // times.
    EXPECT_LT(many, 100 * few + 0.01) << unit;
  }
}

TEST(Text, KnowsWhatTheOtherColumnsLeaveForOne) {
  Table t;
  t.columns = {{"axis"}, {"fault"}, {"raw", "", Show::json}, {"state"}};
  t.rows = {{"feeder", "a long text", 1, "送料"}};
  EXPECT_EQ(room_for(t, 1, 40), 40U - 6 - 2 - 5 - 2);
  EXPECT_EQ(room_for(t, 1, 10), 0U);
  EXPECT_EQ(room_for(t, 1, 0), std::string::npos);
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

TEST(Text, WritesNumbersWithoutExponents) {
  EXPECT_EQ(to_text(List{1310720.0, 0.0000931, 2.5e13, -0.1}), "1310720\n0.0000931\n25000000000000\n-0.1\n");
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

TEST(Text, OfATableCutsNoWordNumberOrPath) {
  Table t;
  t.columns = {{"id"}, {"name"}, {"range"}, {"file"}};
  t.rows = {{"Pn1018", "Encoder turns of the motor since", "-65535..65535", "a/b/feeder.json"}};
  EXPECT_EQ(to_text(t, 54),
            "id      name            range          file\n"
            "Pn1018  Encoder turns   -65535..65535  a/b/feeder.json\n"
            "        of the motor\n"
            "        since\n");
  EXPECT_NE(to_text(t, 46).find("-65535.."), std::string::npos);
  EXPECT_EQ(to_text(t, 30),
            "id     Pn1018\n"
            "name   Encoder turns of the\n"
            "       motor since\n"
            "range  -65535..65535\n"
            "file   a/b/feeder.json\n");
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

/// Of a large dictionary there are hundreds of thousands.
TEST(Value, IsSmall) { EXPECT_LE(sizeof(Value), 40U); }

TEST(Value, CopiesItsTableAndHasNoneOnceItIsMoved) {
  Value first(table());
  Value copy(first);
  copy.table()->rows.clear();
  EXPECT_EQ(first.table()->rows.size(), 2U);
  copy = first;
  EXPECT_EQ(to_json(copy), to_json(first));
  const Value taken(std::move(first));
  EXPECT_EQ(taken.table()->rows.size(), 2U);
  EXPECT_EQ(first.table(), nullptr);  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(to_json(first), "null");
  EXPECT_EQ(Value(first).table(), nullptr);
  EXPECT_EQ(Value(7).table(), nullptr);
}

}  // namespace
}  // namespace servoctl::report
