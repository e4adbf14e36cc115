// What the library that reads TOML says of a broken file is Chinese as well: it has texts of its own.
#include <gtest/gtest.h>

#include <set>

#include "chinese_words.hpp"
#include "drive/toml_reader.hpp"
#include "report/catalogue.hpp"

namespace servoctl::cli {
namespace {

using namespace std::string_literals;

const std::vector<std::string>& broken() {
  static const std::vector<std::string> all{"a",
                                            "a =",
                                            "a = [",
                                            "a = [1,,2]",
                                            "a = [,1]",
                                            "a = [1 2]",
                                            "a = {b = 1",
                                            "a = {b = 1,}",
                                            "a = {,b = 1}",
                                            "a = {b}",
                                            "a = {b = 1 c = 2}",
                                            "a = {b = 1\n}",
                                            "a = 1 b = 2",
                                            "= 1",
                                            "[a",
                                            "[]",
                                            "[ [a]]",
                                            "[[a] ]",
                                            "[a] x",
                                            "[a]\n[a]",
                                            "a = 1\na = 2",
                                            "a = 1\n[a]",
                                            "a = 1\n[[a]]",
                                            "a = []\n[[a]]",
                                            "a = {}\na.b = 1",
                                            "a = {}\n[a.b]",
                                            "a = 1\na.b = 1",
                                            "[a.b]\n[a]\nb.c = 1",
                                            "a = tru",
                                            "a = truex",
                                            "a = fals",
                                            "a = 1_",
                                            "a = _1",
                                            "a = 1__2",
                                            "a = 01",
                                            "a = 1x",
                                            "a = +",
                                            "a = 0x",
                                            "a = 0xg",
                                            "a = 0b2",
                                            "a = 0o8",
                                            "a = 0x_1",
                                            "a = 1.",
                                            "a = 1.e1",
                                            "a = 1.x",
                                            "a = 1e",
                                            "a = 1e+",
                                            "a = 1.5_",
                                            "a = .5",
                                            "a = 1e1.5",
                                            "a = 0x1p5",
                                            "a = 0x1.8p1",
                                            "a = in",
                                            "a = infx",
                                            "a = nax",
                                            "a = 99999999999999999999",
                                            "a = -9223372036854775809",
                                            "a = 0xFFFFFFFFFFFFFFFFF",
                                            "a = 1e999999",
                                            "a = " + std::string(2000, '1'),
                                            "a = 1.0" + std::string(2000, '1'),
                                            "a = 2020-13-01",
                                            "a = 2020-02-30",
                                            "a = 2020-1-1",
                                            "a = 2020-01-01T25:00:00",
                                            "a = 2020-01-01T00:60:00",
                                            "a = 2020-01-01T00:00:61",
                                            "a = 2020-01-01T00:00:00+25:00",
                                            "a = 2020-01-01T00:00:00+0100",
                                            "a = 25:00:00",
                                            "a = 00:00",
                                            "a = 00:00:0",
                                            "a = 00:00:00.",
                                            "a = 00:00:00.x",
                                            "a = 2020-01-01 x",
                                            "a = 2020/01/01",
                                            "a = 2020-01-01T00:00:00x",
                                            "a = 12345-01-01",
                                            "a = \"x",
                                            "a = 'x",
                                            "a = \"\"\"x",
                                            "a = '''x",
                                            "a = \"\\q\"",
                                            "a = \"\\u12\"",
                                            "a = \"\\uD800\"",
                                            "a = \"\\UFFFFFFFF\"",
                                            "a = \"\\x41\"",
                                            "a = \"\\e\"",
                                            "a = \"x\ny\"",
                                            "a = \"\"\"x\\ y\"\"\"",
                                            "a = \"x\x01\"",
                                            "a = 'x\x01'",
                                            "a = 1 # \x01",
                                            "\x01",
                                            "a\rb",
                                            "a = 1\r\r",
                                            "\"\"\"a\"\"\" = 1",
                                            "a.'''b''' = 1",
                                            "a. = 1",
                                            "a..b = 1",
                                            "[a.]",
                                            "[\n",
                                            "a = \xED\xA0\x80",
                                            "# \xED\xA0\x80",
                                            "a = \"\xED\xA0\x80\"",
                                            "a = " + std::string(300, '['),
                                            "a = \"" + "\0"s + "\"",
                                            "a = \xFF",
                                            "a = 00:00:00.1234567891",
                                            "a = 0xABCDEFG",
                                            "a = 1979-05-27T",
                                            "a = 1.2.3",
                                            "a = @",
                                            "a = \"x\" y",
                                            "a.b = 1\na = 2",
                                            "a = 1 ]",
                                            "a = 1 }"};
  return all;
}

TEST(Chinese, LeavesNoEnglishWordInWhatIsSaidOfABrokenTomlFile) {
  std::set<std::string> said;
  std::set<std::string> left;
  for (const auto& text : broken()) {
    const auto parsed = toml::parse(text);
    if (parsed) continue;
    const std::string english(parsed.error().description());
    said.insert(english);
    if (const auto words = english_words(report::in_chinese(english)); !words.empty())
      left.insert(english + "  ->  " + report::in_chinese(english));
  }
  EXPECT_GT(said.size(), 70U);
  for (const auto& line : left) ADD_FAILURE() << line;
}

}  // namespace
}  // namespace servoctl::cli
