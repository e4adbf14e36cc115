// The writer of JSON beside nlohmann's, to the byte.
#include <gtest/gtest.h>

#include <rapidcheck.h>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "report/json_writer.hpp"
#include "report/value.hpp"

namespace servoctl::report {
namespace {

using Json = nlohmann::ordered_json;

std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// The same values in the form of nlohmann, which writes fewer characters as escapes.
std::string plainly(const std::string& json) { return dump(Json::parse(json)); }

Json number(double d) {
  if (d == std::floor(d) && std::abs(d) < 9.0e15) return static_cast<std::int64_t>(d);
  return d;
}

/// A tree of records and lists with these leaves, built for both.
std::pair<Value, Json> tree(const std::vector<std::string>& texts, const std::vector<double>& numbers) {
  std::pair<Value, Json> out{Record{}, Json::object()};
  auto& record = std::get<Record>(out.first.data());
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const auto key = texts[i] + std::to_string(i);
    record.push_back({key, texts[i]});
    record.push_back({key + " in text", "not here", Show::text});
    out.second[key] = texts[i];
  }
  List list;
  Json array = Json::array();
  for (const double d : numbers) {
    list.emplace_back(Record{{"number", d}, {"none", Value()}});
    array.push_back({{"number", number(d)}, {"none", nullptr}});
  }
  record.push_back({"numbers of all", std::move(list)});
  out.second["numbers of all"] = std::move(array);
  return out;
}

TEST(Json, IsThatOfNlohmann) {
  const auto holds = rc::check([](const std::vector<std::string>& texts, const std::vector<double>& numbers) {
    const auto both = tree(texts, numbers);
    RC_ASSERT(plainly(to_json(both.first)) == plainly(dump(both.second)));
  });
  EXPECT_TRUE(holds);
}

TEST(Json, WritesEveryByteAndEveryBrokenPairAsNlohmannDoes) {
  for (int a = 0; a < 256; ++a)
    for (int b = 0; b < 256; ++b) {
      const std::string text{'x', static_cast<char>(a), static_cast<char>(b), 'y'};
      ASSERT_EQ(plainly(to_json(Value(text))), plainly(dump(text))) << a << " " << b;
    }
  for (const std::string text : {"位置环 \"增益\"\n", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xF0\x9F\x98\x80",
                                 "\xEF\xBF\xBF", "\xE4\xBD", ""})
    EXPECT_EQ(plainly(to_json(Value(text))), plainly(dump(text)));
}

TEST(Json, WritesNumbersOfEveryKindAsNlohmannDoes) {
  for (const double d : {0.0, -0.0, 0.1, -2.5, 1e-7, 123456789.125, 1e15, 9.1e15, -9.1e15, 1e300, 5e-324,
                         std::numeric_limits<double>::max(), std::numeric_limits<double>::infinity(),
                         std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(to_json(Value(d)), dump(number(d)));
  // The times of recordings.
  for (std::int64_t us = 1'700'000'000'000'000; us < 1'700'000'000'100'000; us += 7)
    ASSERT_EQ(to_json(Value(static_cast<double>(us) / 1e6)), dump(number(static_cast<double>(us) / 1e6)));
  EXPECT_EQ(to_json(Value(std::numeric_limits<std::int64_t>::min())), "-9223372036854775808");
}

TEST(Json, ShowsNoControlAndNothingThatHidesYetCarriesIt) {
  const std::string text = "a\x1B\x7F\u009B\u202E\u200B\u2028\uFEFF\U000E0041\uFFFE位";
  const auto json = to_json(Value(text));
  EXPECT_EQ(json, R"("a\u001b\u007f\u009b\u202e\u200b\u2028\ufeff\udb40\udc41\ufffe位")");
  EXPECT_EQ(Json::parse(json).get<std::string>(), text);
}

TEST(JsonWriter, PutsCommasWhereTheyBelong) {
  std::string out = "a line before\n";
  JsonWriter json(out);
  json.begin_list();
  json.begin_list();
  json.end_list();
  json.begin_record();
  json.written("");
  json.member("ends with {", "ends with [");
  json.written("\"b\":1,\"c\":2");
  json.member("ends with :", Value(List{1, Value(), true}));
  json.text_or_null("nothing", "");
  json.end_record();
  json.value(false);
  json.value(std::uint8_t{7});
  json.end_list();
  EXPECT_EQ(
      out,
      "a line before\n"
      R"([[],{"ends with {":"ends with [","b":1,"c":2,"ends with :":[1,null,true],"nothing":null},false,7])");
}

std::string nested(std::size_t levels, const std::string& open, const std::string& close) {
  std::string out;
  for (std::size_t i = 0; i < levels; ++i) out += open;
  out += "1";
  for (std::size_t i = 0; i < levels; ++i) out += close;
  return out;
}

TEST(Json, ThatIsNestedTooDeepIsRefusedWithItsPlace) {
  EXPECT_TRUE(parse_json(nested(64, "[", "]"), "f"));
  EXPECT_TRUE(parse_json(nested(64, "{\"a\":", "}"), "f"));
  const auto list = parse_json("[1,\n" + nested(64, "[", "]") + "]", "f");
  ASSERT_FALSE(list);
  EXPECT_EQ(list.error().message.text(),
            "f:2: column 64: lists and records are nested deeper than 64 levels");
  EXPECT_EQ(list.error().code, Errc::file);
  EXPECT_EQ(list.error().line, 2U);
  // As the stack once was: some hundred thousand levels.
  for (const auto* open : {"[", "{\"a\":"}) {
    const auto deep = parse_json(nested(500'000, open, ""), "f");
    ASSERT_FALSE(deep);
    EXPECT_NE(deep.error().message.text().find("deeper than 64"), std::string::npos);
  }
}

TEST(Json, CountsNoBracketsInText) {
  const auto text =
      parse_json("{\"" + std::string(1000, '[') + "\":\"\\\"" + std::string(1000, '{') + "\"}", "f");
  EXPECT_TRUE(text);
}

TEST(Json, TakesOverWhatIsWrittenAlready) {
  EXPECT_EQ(to_json(Record{{"a", 1}, {"samples", Written{R"([{"b":2}])"}}}),
            R"({"a":1,"samples":[{"b":2}]})");
}

}  // namespace
}  // namespace servoctl::report
