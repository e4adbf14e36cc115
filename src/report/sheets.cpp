#include "report/sheets.hpp"

#include <string_view>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "report/catalogue.hpp"
#include "report/markup.hpp"

namespace servoctl::report {
namespace {

/// What fits into the head of a sheet beside another text, and into the foot beside the number.
constexpr std::size_t kHeadColumns = 50;
constexpr std::size_t kFootColumns = 100;

/// Text as a string of CSS, which no character of it can end, in a <style> that none can end either.
std::string css_string(std::string_view text, std::size_t columns) {
  std::string out;
  for (const char c : clip(printable(text), columns)) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = byte >= 0x80 || c == ' ' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
                       (c >= 'A' && c <= 'Z');
    out += plain ? std::string(1, c) : formatted("\\{:06X} ", byte);
  }
  return '"' + out + '"';
}

}  // namespace

std::string sheet_rules(const Page& page) {
  auto out = formatted(
      "@page {{ size: A4; margin: 18mm 14mm 18mm; font: 8pt sans-serif; color: #444;\n"
      "  @top-left {{ content: {}; text-align: left; white-space: nowrap; }}\n"
      "  @bottom-left {{ content: {}; text-align: left; white-space: nowrap; }}\n"
      "  @bottom-right {{ content: counter(page) \" / \" counter(pages); }} }}\n"
      "@page :first {{ @top-left {{ content: none; }} }}\n",
      css_string(page.title, kHeadColumns), css_string(page.foot, kFootColumns));
  std::size_t sheet = 0;
  for (const auto& section : page.sections)
    if (section.new_sheet) {
      ++sheet;
      out += formatted(
          "@page sheet{0} {{ @top-right {{ content: {1}; text-align: right; white-space: nowrap; }} }}\n"
          ".sheet{0} {{ page: sheet{0}; break-before: page; }}\n",
          sheet, css_string(section.title, kHeadColumns));
    }
  return out;
}

std::string signature_lines(const Page& page) {
  if (page.signatures.empty()) return {};
  const auto say = [&](std::string_view english) { return page.chinese ? chinese_word(english) : english; };
  auto out = formatted(
      "<div class=\"together\">\n<h2>{}</h2>\n<table class=\"signatures\">\n<thead><tr><th></th>"
      "<th>{}</th><th>{}</th><th>{}</th></tr></thead>\n<tbody>\n",
      say("Signatures"), say("name in print"), say("date"), say("signature"));
  for (const auto& who : page.signatures)
    out += formatted("<tr><td>{}</td><td></td><td></td><td></td></tr>\n", escaped(who));
  return out + "</tbody></table>\n</div>\n";
}

}  // namespace servoctl::report
