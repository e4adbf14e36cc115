// What people say of a report: for whom, by whom, which picture, who signs.
#include <gtest/gtest.h>

#include <filesystem>

#include "base/base64.hpp"
#include "report_world.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

const std::string kPng =
    std::string("\x89PNG\r\n\x1A\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x08\2\0\0\0", 29) + "…IEND\xAE\x42\x60\x82";
constexpr std::string_view kSvg =
    "<?xml version=\"1.0\"?><!-- a > b --><!DOCTYPE svg [<!ENTITY a \"b\">]>\n"
    "<svg xmlns=\"http://www.w3.org/2000/svg\"><script>alert(1)</script></svg>\n";

class ReportCover : public ReportWorld {
 protected:
  ReportCover() : ReportWorld("sim:gsd600@1,gsd600@2", "gsd600") {}

  std::string page(const std::string& options, const std::string& name = "report.html") {
    return report(name, options + " --yes");
  }

  /// What is wrong is told before a frame is sent.
  std::string refusal(const std::string& options, int exit) {
    const auto trace = dir_ / "refused.log";
    EXPECT_EQ(
        run("report " + (dir_ / "none.html").string() + " -n 1 --trace " + trace.string() + " " + options),
        exit)
        << console.err_text;
    EXPECT_FALSE(fs::exists(trace) && fs::file_size(trace) > 0) << options;
    EXPECT_FALSE(fs::exists(dir_ / "none.html")) << options;
    return console.err_text;
  }

  static std::size_t count(const std::string& text, const std::string& word) {
    std::size_t out = 0;
    for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++out;
    return out;
  }
};

TEST_F(ReportCover, StandsOnTheFirstPageAndSignsAtTheEnd) {
  const auto html = page("-n 1,2 --customer 'Müller & <b>' --machine 三号压力机 --operator \"A. O'Fitter\"");
  for (const auto* text :
       {"<td>Müller &amp; &lt;b&gt;</td>", "<td>三号压力机</td>", "<td>A. O&#39;Fitter</td>"})
    EXPECT_NE(html.find(text), std::string::npos) << text;
  EXPECT_EQ(count(html, "<b>"), 0U) << "what people type is text";
  EXPECT_LT(html.find("Commissioning engineer"), html.find("<td>Customer</td>"));
  EXPECT_GT(html.find("Commissioning engineer"), html.find("Node 2"));
}

TEST_F(ReportCover, GivesEachDriveASheetOfItsOwn) {
  const auto html = page("-n 1,2 --machine 'Press 3'");
  EXPECT_EQ(count(html, "<section class=\"sheet "), 2U);
  EXPECT_EQ(count(html, "break-before: page"), 2U);
  EXPECT_EQ(count(html, "<h2>Node 2</h2>\n<p class=\"note\">Press 3, 20"), 1U);
}

TEST_F(ReportCover, HasNoLinesToSignUnlessThereIsACustomerOrNames) {
  EXPECT_EQ(page("-n 1").find("Signatures"), std::string::npos);
  EXPECT_EQ(page("-n 1 --customer A --signatures none").find("Signatures"), std::string::npos);
  const auto html = page("-n 1 --signatures '调试, 客户，Witness、TÜV'");
  for (const auto* who : {"<td>调试</td>", "<td>客户</td>", "<td>Witness</td>", "<td>TÜV</td>"})
    EXPECT_EQ(count(html, who), 1U) << who;
  EXPECT_NE(page("-n 1 --customer A --lang zh").find("<td>调试工程师</td>"), std::string::npos);
}

TEST_F(ReportCover, CarriesThePictureInTheFile) {
  for (const auto& [name, content, type] :
       {std::tuple<std::string, std::string, std::string>{"a.png", kPng, "image/png"},
        {"b.jpg", "\xFF\xD8\xFF\xE0 … \xFF\xD9", "image/jpeg"},
        {"svg.png", std::string(kSvg), "image/svg+xml"}}) {
    const auto html = page("-n 1 --logo " + file(name, content));
    EXPECT_EQ(count(html, "<img "), 1U);
    const ByteSpan bytes(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
    EXPECT_NE(html.find("src=\"data:" + type + ";base64," + to_base64(bytes) + "\""), std::string::npos)
        << type;
    EXPECT_NE(html.find("img-src data:"), std::string::npos);
    EXPECT_EQ(html.find("<script"), std::string::npos);
  }
  EXPECT_EQ(page("-n 1").find("img-src"), std::string::npos);
}

TEST_F(ReportCover, RefusesWhatIsNoPictureBeforeADriveIsAsked) {
  EXPECT_NE(refusal("--logo " + (dir_ / "missing.png").string(), 7).find("No such file"), std::string::npos);
  EXPECT_NE(refusal("--logo " + dir_.string(), 7).find("no regular file"), std::string::npos);
  EXPECT_NE(refusal("--logo " + file("text.png", "GIF89a"), 7).find("is no PNG, JPEG or SVG"),
            std::string::npos);
  EXPECT_NE(
      refusal("--logo " + file("page.svg", "<html><svg xmlns=\"http://www.w3.org/2000/svg\"/></html>"), 7)
          .find("is no PNG"),
      std::string::npos);
  EXPECT_NE(refusal("--logo " + file("bare.svg", "<svg></svg>"), 7).find("is no PNG"), std::string::npos);
  EXPECT_NE(refusal("--logo " + file("cut.png", kPng.substr(0, 32)), 7).find("is cut short"),
            std::string::npos);
  EXPECT_NE(refusal("--logo " + file("cut.svg", kSvg.substr(0, 130)), 7).find("is cut short"),
            std::string::npos);
  EXPECT_NE(refusal("--logo " + file("large.png", kPng + std::string(1U << 20U, 'x')), 7)
                .find("larger than 1048576"),
            std::string::npos);
}

TEST_F(ReportCover, RefusesTextThatControlsHidesOrDoesNotFit) {
  for (const auto* option : {"--title", "--customer", "--machine", "--operator", "--signatures"})
    for (const auto* text : {"'a\x1B[2J'", "'a\u202Eb'", "'a\u200Bb'", "'\x9B'", "'a\tb'"})
      EXPECT_NE(refusal(std::string(option) + " " + text, 2).find("control or hide"), std::string::npos)
          << option << text;
  refusal("--customer " + std::string(121, 'x'), 2);
  refusal("--signatures " + std::string(41, 'x'), 2);
  refusal("--signatures a,,b", 2);
  refusal("--signatures a,b,c,d,e,f,g,h,i", 2);
}

TEST_F(ReportCover, IsWholeInJson) {
  const auto said =
      report::parse_json(
          page("-n 1 --customer A --machine 三号 --operator B --signatures C,D --logo " + file("a.png", kPng),
               "said.json"),
          "report")
          .value();
  const auto text = [&](const report::Value& value, std::string_view key) {
    return report::to_json(*report::find(value, key));
  };
  EXPECT_EQ(text(said, "customer"), "\"A\"");
  EXPECT_EQ(text(said, "machine"), "\"三号\"");
  EXPECT_EQ(text(said, "operator"), "\"B\"");
  EXPECT_EQ(text(said, "signatures"), R"(["C","D"])");
  EXPECT_EQ(text(*report::find(said, "logo"), "type"), "\"image/png\"");
  const auto silent = report::parse_json(page("-n 1", "silent.json"), "report").value();
  for (const auto* key : {"customer", "machine", "operator", "signatures", "logo"})
    EXPECT_EQ(text(silent, key), "null") << key;
}

}  // namespace
}  // namespace servoctl::cli
