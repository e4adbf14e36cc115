#include "drive/fault.hpp"

#include <algorithm>
#include <array>

#include "base/csv.hpp"
#include "base/format.hpp"
#include "base/number.hpp"

namespace servoctl::drive {
namespace {

constexpr std::array<std::string_view, 12> kColumns{"code",       "extra",   "panel",        "kind",
                                                    "resettable", "name",    "name_zh",      "check",
                                                    "check_zh",   "assumed", "contradicted", "line"};

tl::unexpected<Error> bad_cell(std::string_view file, std::uint32_t line, std::string_view column,
                               std::string_view cell, std::string_view expected) {
  return fail(file_error(file, line, formatted("column {}: '{}' is not {}", column, cell, expected)));
}

std::optional<std::uint16_t> parse_code(std::string_view text) {
  const auto code = parse_integer(text);
  if (!code || code->negative || code->magnitude > 0xFFFF) return std::nullopt;
  return static_cast<std::uint16_t>(code->magnitude);
}

std::optional<Fault::Kind> parse_kind(std::string_view text) {
  for (const auto kind : {Fault::Kind::fault, Fault::Kind::warning, Fault::Kind::status})
    if (name(kind) == text) return kind;
  return std::nullopt;
}

}  // namespace

std::string_view name(Fault::Kind kind) {
  switch (kind) {
    case Fault::Kind::fault: return "fault";
    case Fault::Kind::warning: return "warning";
    case Fault::Kind::status: return "status";
  }
  return "fault";
}

namespace {

Result<Fault> parse_fault(const CsvTable& table, const CsvTable::Row& row, std::string_view file) {
  const auto cell = [&](std::string_view column) -> std::string {
    const auto at = table.column(column);
    return at < row.cells.size() ? row.cells[at] : std::string();
  };
  Fault fault;
  if (const auto text = cell("code"); !text.empty()) {
    fault.code = parse_code(text);
    if (!fault.code) return bad_cell(file, row.line, "code", text, "a code of 16 bits");
  }
  const auto kind = parse_kind(cell("kind"));
  if (!kind) return bad_cell(file, row.line, "kind", cell("kind"), "fault, warning or status");
  fault.kind = *kind;
  if (const auto text = cell("resettable"); !text.empty()) {
    if (text != "yes" && text != "no")
      return bad_cell(file, row.line, "resettable", text, "yes, no or empty");
    fault.resettable = text == "yes";
  }
  const auto manual_line = parse_integer(cell("line"));
  if (!manual_line) return bad_cell(file, row.line, "line", cell("line"), "a line number");
  fault.line = static_cast<std::uint32_t>(manual_line->magnitude);
  for (const auto& [column, text] :
       {std::pair("extra", &fault.extra), std::pair("panel", &fault.panel), std::pair("name", &fault.name),
        std::pair("name_zh", &fault.name_zh), std::pair("check", &fault.check),
        std::pair("check_zh", &fault.check_zh)})
    *text = cell(column);
  for (const auto& [column, marks] :
       {std::pair("assumed", &fault.doubts.assumed), std::pair("contradicted", &fault.doubts.contradicted)}) {
    auto parsed = od::parse_marks(cell(column));
    if (!parsed) return bad_cell(file, row.line, column, cell(column), "a list such as code 1136;extra");
    *marks = std::move(*parsed);
  }
  if (fault.name.empty()) return bad_cell(file, row.line, "name", "", "a name");
  return fault;
}

}  // namespace

Result<std::vector<Fault>> parse_faults(std::string_view csv, std::string_view file) {
  const auto table = parse_csv(csv, file);
  if (!table) return fail(table.error());
  for (const auto& column : table->columns)
    if (std::find(kColumns.begin(), kColumns.end(), column) == kColumns.end())
      return bad_cell(file, 1, column, column, "a column of a faults table (docs/drive-data.md)");
  std::vector<Fault> faults;
  for (const auto& row : table->rows) {
    auto fault = parse_fault(*table, row, file);
    if (!fault) return fail(fault.error());
    faults.push_back(std::move(*fault));
  }
  return faults;
}

namespace {

constexpr std::string_view kMajor = "{major}";
constexpr std::string_view kMinor = "{minor}";

/// `Er{major}-{minor}` taken apart.
struct PanelPattern {
  std::string_view before, between, after;
};
std::optional<PanelPattern> pattern_of(std::string_view text) {
  const auto major = text.find(kMajor);
  const auto minor = text.find(kMinor);
  if (major == std::string_view::npos || minor == std::string_view::npos || minor < major)
    return std::nullopt;
  const auto middle = major + kMajor.size();
  return PanelPattern{text.substr(0, major), text.substr(middle, minor - middle),
                      text.substr(minor + kMinor.size())};
}

/// Vendor bytes begin with byte 3 of the message.
std::size_t place(std::uint8_t byte) { return byte - 3U; }

}  // namespace

std::string panel_text(const EmergencyRules& rules, const std::array<std::uint8_t, 5>& vendor) {
  const auto pattern = pattern_of(rules.panel);
  if (!pattern) return {};
  return formatted("{}{:02}{}{:x}{}", pattern->before, vendor[place(rules.major_byte)], pattern->between,
                   vendor[place(rules.minor_byte)], pattern->after);
}

std::array<std::uint8_t, 5> panel_bytes(const EmergencyRules& rules, std::string_view panel) {
  std::array<std::uint8_t, 5> out{};
  const auto pattern = pattern_of(rules.panel);
  if (!pattern || !panel.starts_with(pattern->before)) return out;
  panel.remove_prefix(pattern->before.size());
  const auto split = panel.find(pattern->between);
  if (split == std::string_view::npos) return out;
  const auto major = parse_digits(panel.substr(0, split), 10);
  const auto minor = parse_digits(panel.substr(split + pattern->between.size()), 16);
  if (!major || !minor || *major > 0xFF || *minor > 0xFF) return out;
  out[place(rules.major_byte)] = static_cast<std::uint8_t>(*major);
  out[place(rules.minor_byte)] = static_cast<std::uint8_t>(*minor);
  return out;
}

std::vector<const Fault*> faults_of(std::span<const Fault> faults, const EmergencyRules& rules,
                                    std::uint16_t code, const std::array<std::uint8_t, 5>& vendor) {
  const auto panel = panel_text(rules, vendor);
  std::vector<const Fault*> out;
  for (const auto& fault : faults) {
    if (fault.code != code) continue;
    if (!panel.empty() && fault.panel == panel) return {&fault};
    out.push_back(&fault);
  }
  return out;
}

}  // namespace servoctl::drive
