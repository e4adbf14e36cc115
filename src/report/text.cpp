#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "report/chinese_marks.hpp"
#include "report/line.hpp"
#include "report/plot.hpp"
#include "report/table_text.hpp"
#include "report/value.hpp"

namespace servoctl::report {
namespace {

template <class... Fs>
struct Overloaded : Fs... {
  using Fs::operator()...;
};
template <class... Fs>
Overloaded(Fs...) -> Overloaded<Fs...>;  // clang 14 has no aggregate deduction.

}  // namespace

std::string line_text(const Value& value) {
  return std::visit(Overloaded{
                        [](std::monostate) { return std::string("-"); },
                        [](bool b) { return std::string(b ? "yes" : "no"); },
                        [](std::int64_t i) { return formatted("{}", i); },
                        [](std::uint64_t u) { return formatted("{}", u); },
                        [](double d) { return plain_number(d, 12); },
                        [](const std::string& s) { return s; },
                        [](const Hex& h) { return formatted("0x{:0{}X}", h.value, h.digits); },
                        [](const List& l) {
                          std::string out;
                          for (const auto& v : l) append(out, line_text(v));
                          return out;
                        },
                        [](const Record& r) {
                          std::string out;
                          for (const auto& f : r)
                            if (f.show != Show::json) append(out, f.key + "=" + line_text(f.value));
                          return out;
                        },
                        [](const Boxed<Table>&) { return std::string(); },
                        [](const Boxed<Plot>&) { return std::string(); },
                        [](const Written& w) { return w.json; },
                    },
                    value.data());
}

namespace {

bool has_own_lines(const Value& value) {
  return value.table() != nullptr || std::holds_alternative<Record>(value.data()) || value.plot() != nullptr;
}

std::string record_text(const Record& record, std::size_t width) {
  std::size_t left = 0;
  for (const auto& field : record)
    if (field.show != Show::json && !has_own_lines(field.value))
      left = std::max(left, display_width(title_of(field)));
  std::string out;
  std::string blocks;  // Below the lines, whatever their place.
  for (const auto& field : record) {
    if (field.show == Show::json || field.value.is_null()) continue;
    if (has_own_lines(field.value))
      blocks += "\n" + chinese_marks(title_of(field) + ":") + "\n" + to_text(field.value, width);
    else
      out += pad_right(title_of(field), left + kColumnGap) +
             wrapped(cell_text(field.value), left + kColumnGap, width) + '\n';
  }
  return out + blocks;
}

std::string lines_below(const Table& table, std::size_t width) {
  std::string out;
  for (const auto& line : table.below) {
    const auto shown = printable(line);
    const auto indent = std::min(shown.find_first_not_of(' '), shown.size());
    // What fits was laid out at this width; what does not is broken behind its own indent.
    const bool fits = width == 0 || display_width(shown) <= width;
    out += (fits ? shown
                 : std::string(indent, ' ') + wrapped(shown.substr(indent), indent + kColumnGap, width)) +
           '\n';
  }
  return out.empty() || table.columns.empty() ? out : '\n' + out;
}

}  // namespace

std::string to_text(const Value& value, std::size_t width) {
  if (value.is_null()) return {};
  if (const auto* table = value.table())
    return table->json_only ? std::string() : table_text(*table, width) + lines_below(*table, width);
  if (const auto* plot = value.plot())
    return braille_plot(plot->series, width == 0 ? kPlotWidth : std::min(width, kPlotWidth));
  if (const auto* record = std::get_if<Record>(&value.data())) return record_text(*record, width);
  if (const auto* list = std::get_if<List>(&value.data())) {
    std::string out;
    for (const auto& element : *list)
      out += (out.empty() || !has_own_lines(element) ? "" : "\n") + to_text(element, width);
    return out;
  }
  return printable_lines(line_text(value)) + '\n';
}

}  // namespace servoctl::report
