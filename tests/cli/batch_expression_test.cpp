// What `expect` asks, and of which parts of a result.
#include <gtest/gtest.h>

#include "cli/batch/expression.hpp"
#include "cli/batch/result_path.hpp"

namespace servoctl::cli {
namespace {

using report::List;
using report::Record;
using report::Show;
using report::Table;
using report::Value;

/// Two nodes, as `status` and `read` tell of them.
Value two_nodes() {
  Table table;
  table.columns = {{"node"}, {"shown", "", Show::text}, {"value"}, {"state"}, {"ready"}, {"bits"}, {"fault"}};
  table.rows = {
      {1, "1 of 2", 400, "operation enabled", true, List{"remote", "target reached"},
       Record{{"code", report::Hex{0xFF00}}}},
      {2, "2 of 2", 40.000000000000001, "switched on", true, List{"remote"}, Record{{"code", Value()}}}};
  return table;
}

Result<std::string> no_variable(std::string_view) { return fail(Errc::usage, "no variable"); }

/// Empty when it holds, else the message.
std::string refusal(std::string_view text, const Value& result = two_nodes()) {
  const auto expression = parse_expression(text, no_variable);
  if (!expression) return "unreadable: " + expression.error().message.text();
  const auto met = expect(*expression, result);
  return met ? std::string() : met.error().message.text();
}

TEST(Expectation, LooksIntoSamplesThatAreKeptAsJson) {
  const report::Written kept{R"([{"node":1,"service":"pdo"},{"node":2,"service":"sdo"}])"};
  EXPECT_EQ(refusal(".samples[1].service == 'sdo'", Record{{"frames", 2}, {"samples", kept}}), "");
  EXPECT_EQ(refusal("[0].node == 1", kept), "");
  EXPECT_NE(refusal("[0].node == 2", kept), "");
}

TEST(Expectation, ComparesNumbersAsNumbersAndTextAsText) {
  for (const auto* text :
       {"[0].value == 400", "[0].value==0x190", "[0].value != 401", "[0].value < 400.5", "[0].value <= 400",
        "[0].value > -1", "[0].value >= 400", "[1].value == 40", "[0].fault.code == 65280",
        "[0].state == \"operation enabled\"", "[0].state == 'operation enabled'", "[1].state ~ on",
        "400 == [0].value", "[0].ready", "[0].ready == true", "[1].fault.code == null",
        "[0].bits ~ \"target reached\"", "[0].bits[0] == remote", "[1].state != \"operation enabled\""})
    EXPECT_EQ(refusal(text), "") << text;
  for (const auto* text :
       {"[0].value == 401", "[0].value != 400", "[0].value < 400", "[0].value <= 399", "[0].value > 400",
        "[0].value >= 401", "[0].state == operation", "[0].state ~ off", "[0].bits ~ target", "[0].value",
        "[0].ready == false", "[0].state == \"400\"", "[1].fault.code == 0"})
    EXPECT_NE(refusal(text), "") << text;
}

TEST(Expectation, ComparesIntegersExactly) {
  const Record result{{"serial", std::uint64_t{18'446'744'073'709'551'615U}},
                      {"least", std::int64_t{-9'223'372'036'854'775'807}},
                      {"hex", report::Hex{0xFFFF'FFFF'FFFF, 12}},
                      {"scaled", 0.1 * 3}};
  for (const auto* text :
       {".serial == 18446744073709551615", ".serial > 18446744073709551614", ".hex == 0xFFFFFFFFFFFF",
        ".hex < 0x1000000000000", ".least != -9223372036854775806", ".scaled == 0.3"})
    EXPECT_EQ(refusal(text, result), "") << text;
  for (const auto* text : {".serial == 18446744073709551614", ".serial <= 18446744073709551614",
                           ".hex >= 0x1000000000000", ".least == -9223372036854775806", ".scaled == 0.31"})
    EXPECT_NE(refusal(text, result), "") << text;
}

TEST(Expectation, ShowsBothSidesWhenItDoesNotHold) {
  EXPECT_EQ(refusal("[0].value == 500"), "[0].value is 400, expected == 500");
  EXPECT_EQ(refusal("[0].state == \"switched on\""),
            "[0].state is \"operation enabled\", expected == \"switched on\"");
  EXPECT_EQ(refusal("[0].bits ~ fault"), R"([0].bits is ["remote","target reached"], expected ~ fault)");
  EXPECT_EQ(refusal("[0].value == [1].value"), "[0].value is 400, expected == [1].value = 40");
  EXPECT_EQ(refusal("count == 3"), "count is 2, expected == 3");
  EXPECT_EQ(refusal("[0].fault.code"), "[0].fault.code is 65280, expected true");
}

TEST(Expectation, OfAFieldOfAListHasToHoldForEveryElement) {
  EXPECT_EQ(refusal(".ready and .value >= 40"), "");
  EXPECT_EQ(refusal(".state == \"operation enabled\""),
            "[1].state is \"switched on\", expected == \"operation enabled\"");
  EXPECT_EQ(refusal(".value != 40"), "[1].value is 40, expected != 40");
  EXPECT_EQ(refusal(".value == 1", List{}), "the result is an empty list: nothing to compare");
}

TEST(Expectation, NeedsAllItsParts) {
  EXPECT_EQ(refusal("[0].value == 400 and [1].value == 40"), "");
  EXPECT_EQ(refusal("[0].value == 400 and [1].value == 41"), "[1].value is 40, expected == 41");
  EXPECT_EQ(refusal("[0].value == 401 and [1].value == 40"), "[0].value is 400, expected == 401");
}

TEST(Expectation, CountsElements) {
  EXPECT_EQ(refusal("count == 2"), "");
  EXPECT_EQ(refusal("count(.) == 2"), "");
  EXPECT_EQ(refusal("count([0].bits) > count([1].bits)"), "");
  EXPECT_EQ(refusal("count == 0", List{}), "");
  EXPECT_EQ(refusal("count([0].value) == 1"), "[0].value is not a list and cannot be counted");
}

TEST(Expectation, OfWhatIsNotThereDoesNotHold) {
  EXPECT_EQ(refusal("[2].value == 1"), "the result has no element 2");
  EXPECT_EQ(refusal("[0].volts == 1"), "[0] has no field volts");
  EXPECT_EQ(refusal("[0].value.more == 1"), "[0].value has no field more");
  EXPECT_EQ(refusal(".value == 1", Value()), "the result has no field value");
  const auto met = expect(parse_expression("[0].volts == 1", no_variable).value(), two_nodes());
  EXPECT_EQ(met.error().code, Errc::negative);
  EXPECT_EQ(met.error().hint.text(), "it has node, value, state, ready, bits or fault");
  EXPECT_EQ(refusal("[0].state < 5"),
            "[0].state (\"operation enabled\") is not a number: < cannot compare it");
}

TEST(Expectation, KeepsTheLastDigitOfLongNumbers) {
  const Value result = Record{{"serial", std::uint64_t{0xFFFFFFFFFFFFFFFF}}, {"least", std::int64_t{-5}}};
  EXPECT_EQ(refusal(".serial == 0xFFFFFFFFFFFFFFFF", result), "");
  EXPECT_EQ(refusal(".least == -5 and .least < 0", result), "");
}

TEST(Expectation, IsRefusedWhenItIsNoExpression) {
  for (const auto* text : {"", ".a ==", "== 5", ".a = 5", ".a == 5 .b == 6", ".a == 5 and", "and", ".a ! 5",
                           ".a == \"open", "[x].a == 5", "[0.a == 5", ".a..b == 5", "count( == 5",
                           ".a == 5 or .b", "count(a) == 5", ".a < < 5"}) {
    const auto expression = parse_expression(text, no_variable);
    ASSERT_FALSE(expression) << text;
    EXPECT_EQ(expression.error().code, Errc::usage) << text;
  }
}

TEST(Expectation, FillsInVariablesWithoutReadingThemAsAnExpression) {
  const auto variables = [](std::string_view name) -> Result<std::string> {
    if (name == "I") return std::string("1");
    return std::string("switched on\" and .value == \"0");
  };
  EXPECT_TRUE(expect(parse_expression("[${I}].value == 40", variables).value(), two_nodes()));
  EXPECT_EQ(expect(parse_expression("[0].state == \"${TEXT}\"", variables).value(), two_nodes())
                .error()
                .message.text(),
            R"([0].state is "operation enabled", expected == "switched on\" and .value == \"0")");
  EXPECT_FALSE(expect(parse_expression("[1].state == '${TEXT}'", variables).value(), two_nodes()));
  EXPECT_EQ(parse_expression(".a == ${I}", no_variable).error().message.text(), "no variable");
}

TEST(Expectation, IsWrittenAsItIsRead) {
  for (const auto* text : {"[0].value == 400 and .state ~ \"operation enabled\"", "count >= 2",
                           "count(.events) < 3", ".written"})
    EXPECT_EQ(to_string(parse_expression(text, no_variable).value()), text);
  EXPECT_EQ(to_string(parse_expression(".a==5 # why", no_variable).value()), ".a == 5");
}

}  // namespace
}  // namespace servoctl::cli
