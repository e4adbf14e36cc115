#include "report/html.hpp"

#include <gtest/gtest.h>

namespace servoctl::report {
namespace {

TEST(Html, ShowsWhatTextShows) {
  Table table;
  table.columns = {{"object", "", Show::text}, {"name"}, {"raw", "", Show::json}, {"value"}, {"empty"}};
  table.rows = {{"0x6040", "Controlword", 6, 6, Value()}, {"0x607A", "目标位置", -20, Value(), ""}};
  const Record record{{"node", 1},
                      {"secret", "for programs", Show::json},
                      {"nothing", Value()},
                      {"energised", false, Show::everywhere, "is energised"},
                      {"modes", List{"pp", "pv"}},
                      {"no_modes", List{}},
                      {"objects", table}};
  EXPECT_EQ(
      to_html(record),
      "<table class=\"fields\"><tbody>\n<tr><th>node</th><td>1</td></tr>\n"
      "<tr><th>is energised</th><td>no</td></tr>\n<tr><th>modes</th><td>pp, pv</td></tr>\n</tbody></table>\n"
      "<h4>objects</h4>\n<div class=\"wide\"><table class=\"rows\">\n"
      "<thead><tr><th>object</th><th>name</th><th class=\"number\">value</th></tr></thead>\n<tbody>\n"
      "<tr><td class=\"short tiny\">0x6040</td><td class=\"short\">Controlword</td><td "
      "class=\"number\">6</td></tr>\n"
      "<tr><td class=\"short tiny\">0x607A</td><td class=\"short tiny\">目标位置</td><td "
      "class=\"number\">–</td></tr>\n</tbody></table></div>\n");
}

TEST(Html, LetsNoValueKeyOrHeadingBecomeMarkup) {
  const std::string evil = "<img src=x onerror=\"alert(1)\">";
  Table table;
  table.columns = {{evil}};
  table.rows = {{evil}};
  Page page;
  page.title = evil;
  page.translate = [](std::string_view word) { return std::string(word); };
  page.sections = {{evil, 2, Record{{evil, evil}, {"t", table}, {"p", Plot{{{evil, evil, {0}, {1}}}}}}, evil},
                   {"list", 2, List{evil, Record{{"a", evil}}}}};
  const auto html = html_page(page);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_NE(html.find("&lt;img src=x onerror=&quot;alert(1)&quot;&gt;"), std::string::npos);
}

TEST(Html, PutsHeadingsAndYesAndNoIntoTheReadersLanguage) {
  const auto translate = [](std::string_view word) {
    return std::string(word == "yes" ? "是" : word == "node" ? "节点" : word);
  };
  EXPECT_EQ(to_html(Record{{"node", true}, {"name", "yes"}}, translate),
            "<table class=\"fields\"><tbody>\n<tr><th>节点</th><td>是</td></tr>\n"
            "<tr><th>name</th><td>yes</td></tr>\n</tbody></table>\n");
}

TEST(Html, DrawsPlots) {
  const auto html = to_html(Record{{"samples", Plot{{{"velocity", "rpm", {0, 1}, {0, 60}}}}}});
  EXPECT_TRUE(html.starts_with("<h4>samples</h4>\n<svg "));
}

TEST(Html, LetsNoTitleEndTheStyleSheet) {
  Page page;
  page.title = "a</style><script>\"; } b";
  page.foot = "back\\slash & \n";
  page.sections = {{"\" }", 2, {}, {}, true}};
  const auto html = html_page(page);
  EXPECT_EQ(html.find("</style><script>"), std::string::npos);
  EXPECT_NE(
      html.find("content: \"a\\00003C \\00002F style\\00003E \\00003C script\\00003E \\000022 \\00003B  "
                "\\00007D  b\";"),
      std::string::npos);
  EXPECT_NE(html.find("content: \"back\\00005C slash \\000026  \\00005C n\";"), std::string::npos);
  EXPECT_NE(html.find("content: \"\\000022  \\00007D \";"), std::string::npos);
}

TEST(Html, BeginsASheetWhereASectionSaysSoAndSignsWithinTheLast) {
  Page page;
  page.title = "T";
  page.sections = {{"cover"}, {"one", 2, {}, {}, true}, {"part", 3}, {"two", 2, {}, {}, true}};
  page.signatures = {"<who>"};
  const auto html = html_page(page);
  const auto body = html.substr(html.find("<body>"));
  EXPECT_TRUE(
      body.starts_with("<body>\n<h1>T</h1>\n<h2>cover</h2>\n<section class=\"sheet sheet1\">\n<h2>one</h2>\n"
                       "<h3>part</h3>\n</section>\n<section class=\"sheet sheet2\">\n<h2>two</h2>\n"
                       "<div class=\"together\">\n<h2>Signatures</h2>"))
      << body;
  EXPECT_TRUE(
      body.ends_with("<tr><td>&lt;who&gt;</td><td></td><td></td><td></td></tr>\n</tbody></table>\n</div>\n"
                     "</section>\n</body>\n</html>\n"))
      << body;
}

TEST(Html, IsAPageThatLoadsNothing) {
  Page page;
  page.chinese = true;
  page.title = "调试报告";
  const auto html = html_page(page);
  EXPECT_TRUE(html.starts_with("<!DOCTYPE html>\n<html lang=\"zh-CN\">"));
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  for (const auto* word : {"<script", "<link", "http:", "https:", "url(", "@import"})
    EXPECT_EQ(html.find(word), std::string::npos) << word;
}

}  // namespace
}  // namespace servoctl::report
