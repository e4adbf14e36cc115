#include "od/ini.hpp"

#include "tests/od/eds_support.hpp"
#include "tests/od/guarded_text.hpp"

namespace servoctl::od {
namespace {

/// `section:key=value@line:column` of every key.
std::vector<std::string> keys_of(const IniText& ini) {
  std::vector<std::string> out;
  for (const auto& section : ini.sections)
    for (const auto& key : section.keys)
      out.push_back(std::string(section.name) + ":" + std::string(key.key) + "=" + std::string(key.value) +
                    "@" + std::to_string(key.line) + ":" + std::to_string(key.value_column));
  return out;
}

std::vector<std::string> strays_of(const IniText& ini) {
  std::vector<std::string> out;
  for (const auto& stray : ini.strays)
    out.push_back(std::to_string(stray.line) + " " + std::string(stray.text));
  return out;
}

using Texts = std::vector<std::string>;

TEST(Ini, TellsLineAndColumnOfEveryValue) {
  const GuardedText text("[a]\nk=v\n \tlong name \t=  value \n[b]\ne=\n  f  =  \ng==\n;c=d\n\nlast=1");
  EXPECT_EQ(keys_of(parse_ini(text.text())), (Texts{"a:k=v@2:3", "a:long name=value@3:17", "b:e=@5:3",
                                                    "b:f=@6:7", "b:g==@7:3", "b:last=1@10:6"}));
}

TEST(Ini, CountsLinesHoweverTheyEnd) {
  for (const auto* end : {"\n", "\r\n", "\r"}) {
    const std::string e(end);
    const GuardedText text("[a]" + e + e + "k=v" + e + "l=w" + e);
    EXPECT_EQ(keys_of(parse_ini(text.text())), (Texts{"a:k=v@3:3", "a:l=w@4:3"}));
  }
  EXPECT_EQ(keys_of(parse_ini("[a]\n\rk=v\r\n\r\nl=w\r\rm=x")),
            (Texts{"a:k=v@3:3", "a:l=w@5:3", "a:m=x@7:3"}));
}

TEST(Ini, TakesNamesOfSectionsUpToTheBracket) {
  const auto ini = parse_ini("[ a b ] rest\n[]\n[open \n");
  ASSERT_EQ(ini.sections.size(), 3U);
  EXPECT_EQ(ini.sections[0].name, "a b");
  EXPECT_TRUE(ini.sections[0].closed);
  EXPECT_EQ(ini.sections[1].name, "");
  EXPECT_TRUE(ini.sections[1].closed);
  EXPECT_EQ(ini.sections[2].name, "open");
  EXPECT_FALSE(ini.sections[2].closed);
  EXPECT_EQ(ini.sections[2].line, 3U);
}

TEST(Ini, TellsLinesThatAreNothing) {
  const auto ini = parse_ini("early=1\n[a]\n=5\n#k=v\nword\n\x01 \x02\n\x01\x1A\n;\n");
  EXPECT_EQ(strays_of(ini), (Texts{"1 early=1", "3 =5", "4 #k=v", "5 word", "6 \x01 \x02"}));
  EXPECT_EQ(keys_of(ini), Texts{});
}

TEST(IniSection, FindsTheLastKeyOfANameInAnyCase) {
  const auto ini = parse_ini("[a]\nKey=1\nkEY=2\nkez=3\nake=4\nkeys=5\n[b]\nkey=6\n");
  EXPECT_EQ(ini.sections[0].find("key")->value, "2");
  EXPECT_EQ(ini.sections[0].find("KEYS")->value, "5");
  EXPECT_EQ(ini.sections[1].find("KeY")->value, "6");
  EXPECT_EQ(ini.sections[1].find("keys"), nullptr);
  EXPECT_EQ(ini.sections[1].find(""), nullptr);
}

}  // namespace
}  // namespace servoctl::od
