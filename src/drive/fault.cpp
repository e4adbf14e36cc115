#include "drive/fault.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>

#include "base/csv.hpp"
#include "base/number.hpp"

namespace servoctl::drive {
namespace {

constexpr std::array<std::string_view, 11> kColumns{"code",       "extra",   "panel",   "kind",
                                                    "resettable", "name",    "name_zh", "check",
                                                    "check_zh",   "assumed", "line"};

tl::unexpected<Error> bad_cell(std::string_view file, std::uint32_t line, std::string_view column,
                               std::string_view cell, std::string_view expected) {
  Error error;
  error.code = Errc::file;
  error.message = fmt::format("{}:{}: column {}: '{}' is not {}", file, line, column, cell, expected);
  error.line = line;
  return fail(std::move(error));
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

Result<std::vector<Fault>> parse_faults(std::string_view csv, std::string_view file) {
  const auto table = parse_csv(csv, file);
  if (!table) return tl::unexpected<Error>(table.error());
  for (const auto& column : table->columns)
    if (std::find(kColumns.begin(), kColumns.end(), column) == kColumns.end())
      return bad_cell(file, 1, column, column, "a column of a faults table (docs/drive-data.md)");
  std::vector<Fault> faults;
  for (const auto& row : table->rows) {
    const auto cell = [&](std::string_view column) -> std::string {
      const auto at = table->column(column);
      return at < row.cells.size() ? row.cells[at] : std::string();
    };
    Fault fault;
    if (const auto text = cell("code"); !text.empty()) {
      const auto code = parse_integer(text);
      if (!code || code->negative || code->magnitude > 0xFFFF)
        return bad_cell(file, row.line, "code", text, "a code of 16 bits");
      fault.code = static_cast<std::uint16_t>(code->magnitude);
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
    fault.extra = cell("extra");
    fault.panel = cell("panel");
    fault.name = cell("name");
    fault.name_zh = cell("name_zh");
    fault.check = cell("check");
    fault.check_zh = cell("check_zh");
    fault.assumed = cell("assumed");
    if (fault.name.empty()) return bad_cell(file, row.line, "name", "", "a name");
    faults.push_back(std::move(fault));
  }
  return faults;
}

}  // namespace servoctl::drive
