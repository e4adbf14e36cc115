#include "report/html.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "report/line.hpp"
#include "report/markup.hpp"
#include "report/sheets.hpp"
#include "report/svg.hpp"

namespace servoctl::report {
namespace {

/// What a reader needs: a column that fits a telephone, tables that scroll instead of the page, and on paper
/// nothing that is cut.
constexpr std::string_view kStyle = R"(
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 60rem; padding: 1rem; background: #fff; color: #111;
  font: 15px/1.45 "Noto Sans", "DejaVu Sans", "Noto Sans CJK SC", "Microsoft YaHei", "PingFang SC", sans-serif; }
h1 { font-size: 1.7rem; margin: 0 0 .5rem; }
h2 { font-size: 1.3rem; margin: 2rem 0 .5rem; padding-bottom: .2rem; border-bottom: 2px solid #111; }
h3 { font-size: 1.05rem; margin: 1.4rem 0 .4rem; }
h4, h5, h6 { font-size: 1rem; margin: 1rem 0 .3rem; font-weight: 600; }
h5, h6 { font-size: .9rem; color: #444; }
h1, h2, h3, h4, h5, h6 { line-height: 1.2; overflow-wrap: anywhere; }
p { margin: .3rem 0; }
.wide { overflow-x: auto; margin: .3rem 0; }
table { border-collapse: collapse; }
th, td { padding: .2rem .7rem .2rem 0; text-align: left; vertical-align: top; }
table.fields th { font-weight: normal; color: #444; white-space: nowrap; padding-right: 1.2rem; }
table.fields td { overflow-wrap: anywhere; }
table.rows thead th { border-bottom: 1px solid #111; white-space: nowrap; }
table.rows td { border-bottom: 1px solid #ccc; }
.short { white-space: nowrap; }
.number { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
svg { display: block; max-width: 100%; height: auto; margin: .5rem 0; }
.picture { display: block; max-width: 16rem; max-height: 6rem; margin: 0 0 1rem; }
table.signatures { width: 100%; table-layout: fixed; }
table.signatures th { font-weight: normal; color: #444; }
table.signatures td { height: 4rem; vertical-align: bottom; border-bottom: 1px solid #111; overflow-wrap: anywhere; }
@media print {
  html { font-size: 9.5pt; }
  body { max-width: none; padding: 0; font-size: 9.5pt; }
  .wide { overflow: visible; }
  table.rows td { overflow-wrap: anywhere; }
  table.rows thead th, .short { white-space: normal; }
  .tiny { white-space: nowrap; }
  thead { display: table-header-group; }
  tr, svg, .together { break-inside: avoid; }
  h1, h2, h3, h4, h5, h6, .note { break-after: avoid; }
  tr:has(th:empty) { break-before: avoid; }
  .sheet > h2 { margin-top: 0; }
  p { orphans: 3; widows: 3; }
}
)";

bool is_block(const Value& value) {
  if (const auto* list = std::get_if<List>(&value.data()))
    return std::any_of(list->begin(), list->end(), is_block);
  return value.table() != nullptr || std::holds_alternative<Record>(value.data()) || value.plot() != nullptr;
}

bool is_nothing(const Value& value) {
  const auto* list = std::get_if<List>(&value.data());
  return value.is_null() || (list != nullptr && list->empty());
}

/// Cells up to this width stay in one line.
constexpr std::size_t kShort = 20;
/// On paper, which does not scroll, only those up to this one.
constexpr std::size_t kTiny = 8;
/// The lowest level of headings.
constexpr int kLowest = 6;

class Writer {
 public:
  explicit Writer(const Translate& translate) : translate_(&translate) {}

  /// `level` is that of the headings it may need.
  void write(const Value& value, int level) {
    if (const auto* table = value.table()) return write_table(*table);
    if (const auto* record = std::get_if<Record>(&value.data())) return write_record(*record, level);
    if (const auto* plot = value.plot()) {
      out_ += *translate_ ? svg_plot(plot->series, (*translate_)("no samples")) : svg_plot(plot->series);
      return;
    }
    if (const auto* list = std::get_if<List>(&value.data()); list != nullptr && is_block(value)) {
      for (const auto& element : *list) write(element, level);
      return;
    }
    if (!is_nothing(value)) out_ += "<p>" + inline_text(value) + "</p>\n";
  }

  std::string take() { return std::move(out_); }

 private:
  std::string heading(const std::string& title) const {
    return escaped(*translate_ && !title.empty() ? (*translate_)(title) : title);
  }

  std::string inline_text(const Value& value) const {
    if (value.is_null()) return "–";
    if (const auto* truth = std::get_if<bool>(&value.data())) return heading(*truth ? "yes" : "no");
    return escaped(line_text(value));
  }

  void write_table(const Table& table) {
    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < table.columns.size(); ++i)
      if (table.columns[i].show != Show::json && !is_empty(table, i)) shown.push_back(i);
    if (table.rows.empty() || shown.empty()) return;
    out_ += "<div class=\"wide\"><table class=\"rows\">\n<thead><tr>";
    std::vector<bool> numbers(table.columns.size());
    for (const auto i : shown) {
      const auto& column = table.columns[i];
      numbers[i] = is_all_numbers(table, i);
      out_ += formatted("<th{}>{}</th>", numbers[i] ? " class=\"number\"" : "",
                        heading(column.title.empty() ? column.key : column.title));
    }
    out_ += "</tr></thead>\n<tbody>\n";
    for (const auto& row : table.rows) {
      out_ += "<tr>";
      for (const auto i : shown)
        out_ += formatted("<td{}>{}</td>", cell_style(row[i], numbers[i]), inline_text(row[i]));
      out_ += "</tr>\n";
    }
    out_ += "</tbody></table></div>\n";
  }

  static bool is_empty(const Table& table, std::size_t column) {
    return std::all_of(table.rows.begin(), table.rows.end(), [&](const List& row) {
      const auto* text = std::get_if<std::string>(&row[column].data());
      return row[column].is_null() || (text != nullptr && text->empty());
    });
  }

  static bool is_all_numbers(const Table& table, std::size_t column) {
    return std::all_of(table.rows.begin(), table.rows.end(),
                       [&](const List& row) { return row[column].is_number() || row[column].is_null(); });
  }

  static std::string_view cell_style(const Value& value, bool number) {
    if (number || value.is_number()) return " class=\"number\"";
    const auto width = display_width(line_text(value));
    return width <= kTiny ? " class=\"short tiny\"" : width <= kShort ? " class=\"short\"" : "";
  }

  /// The lines first, then what is larger than a line, as in text.
  void write_record(const Record& record, int level) {
    const auto title = [](const Field& f) { return f.title.empty() ? f.key : f.title; };
    std::string lines;
    for (const auto& field : record)
      if (field.show != Show::json && !is_nothing(field.value) && !is_block(field.value))
        lines +=
            formatted("<tr><th>{}</th><td>{}</td></tr>\n", heading(title(field)), inline_text(field.value));
    if (!lines.empty()) out_ += "<table class=\"fields\"><tbody>\n" + lines + "</tbody></table>\n";
    for (const auto& field : record) {
      if (field.show == Show::json || !is_block(field.value)) continue;
      out_ += formatted("<h{0}>{1}</h{0}>\n", level, heading(title(field)));
      write(field.value, std::min(level + 1, kLowest));
    }
  }

  const Translate* translate_;
  std::string out_;
};

}  // namespace

std::string to_html(const Value& value, const Translate& translate, int level) {
  Writer writer(translate);
  writer.write(value, level);
  return writer.take();
}

std::string html_page(const Page& page) {
  std::string body;
  if (!page.picture.empty())
    body += formatted("<img class=\"picture\" alt=\"\" src=\"{}\">\n", escaped(page.picture));
  body += formatted("<h1>{}</h1>\n", escaped(page.title));
  std::size_t sheets = 0;
  for (const auto& section : page.sections) {
    if (section.new_sheet)
      body +=
          formatted("{}<section class=\"sheet sheet{}\">\n", sheets > 0 ? "</section>\n" : "", sheets + 1);
    sheets += section.new_sheet;
    body += formatted("<h{0}>{1}</h{0}>\n", section.level, escaped(section.title));
    if (!section.note.empty()) body += "<p class=\"note\">" + escaped(section.note) + "</p>\n";
    body += to_html(section.value, page.translate, section.level + 1);
  }
  body += signature_lines(page);
  if (sheets > 0) body += "</section>\n";
  // Nothing may be loaded or run, whatever a mistake in here would let through.
  return formatted(
      "<!DOCTYPE html>\n<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "style-src 'unsafe-inline'{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{}</title>\n<style>{}{}</style>\n</head>\n<body>\n{}</body>\n</html>\n",
      page.chinese ? "zh-CN" : "en", page.picture.empty() ? "" : "; img-src data:", escaped(page.title),
      kStyle, sheet_rules(page), body);
}

}  // namespace servoctl::report
