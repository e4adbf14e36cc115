#include "drive/fault.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "base/csv.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "od/table_row.hpp"

namespace servoctl::drive {
namespace {

constexpr std::array<std::string_view, 12> kColumns{"code",       "extra",   "panel",        "kind",
                                                    "resettable", "name",    "name_zh",      "check",
                                                    "check_zh",   "assumed", "contradicted", "line"};

Error bad_cell(std::string_view file, std::uint32_t line, std::string_view column, std::string_view cell,
               std::string_view expected) {
  return file_error(file, line,
                    message("column '{}': '{}' is not {}", as_it_is(column), as_it_is(cell), expected));
}

/// `0x2310`, `2310h`. Bare digits could be decimal or hexadecimal.
std::optional<std::uint16_t> parse_code(std::string_view text) {
  const bool is_marked = starts_with_nocase(text, "0x") || lower(text).ends_with('h');
  const auto code = is_marked ? parse_integer(text) : std::nullopt;
  if (!code || code->negative || code->magnitude > 0xFFFF) return std::nullopt;
  return static_cast<std::uint16_t>(code->magnitude);
}

/// With what to write in place of bare digits.
Error bad_code(std::string_view file, std::uint32_t line, std::string_view text) {
  auto out = bad_cell(file, line, "code", text, "a hexadecimal code of 16 bits, such as 0x8130");
  constexpr std::size_t kDigits = 4;
  if (const auto decimal = parse_digits(text, 10); decimal && text.size() <= kDigits)
    out.hint =
        message("write 0x{} if these digits are hexadecimal, 0x{:04X} if they are decimal", text, *decimal);
  return out;
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

Fault read_fault(const CsvTable& table, const CsvTable::Row& row, std::string_view file,
                 std::vector<Error>& errors) {
  const auto cell = [&](std::string_view column) -> std::string {
    const auto at = table.column(column);
    return at < row.cells.size() ? row.cells[at] : std::string();
  };
  const auto refuse = [&](std::string_view column, std::string_view expected) {
    errors.push_back(bad_cell(file, row.line, column, cell(column), expected));
  };
  const auto marks_in = [&](std::string_view column) {
    auto parsed = od::parse_marks(cell(column));
    if (!parsed) refuse(column, "a list such as code 1136;extra");
    return parsed ? std::move(*parsed) : std::vector<od::Mark>();
  };
  Fault fault;
  if (const auto text = cell("code"); !text.empty()) {
    fault.code = parse_code(text);
    if (!fault.code) errors.push_back(bad_code(file, row.line, text));
  }
  const auto kind_text = cell("kind");
  const auto kind = kind_text.empty() ? Fault::Kind::fault : parse_kind(kind_text);
  if (!kind) refuse("kind", "fault, warning or status");
  fault.kind = kind.value_or(Fault::Kind::fault);
  if (const auto text = cell("resettable"); !text.empty()) {
    if (text != "yes" && text != "no") refuse("resettable", "yes, no or empty");
    fault.resettable = text == "yes";
  }
  const auto line = cell("line");
  const auto manual_line = line.empty() ? std::optional<std::uint64_t>(0) : parse_digits(line, 10);
  if (!manual_line) refuse("line", "a line number");
  fault.line = static_cast<std::uint32_t>(manual_line.value_or(0));
  for (const auto& [column, text] :
       {std::pair("extra", &fault.extra), std::pair("panel", &fault.panel), std::pair("name", &fault.name),
        std::pair("name_zh", &fault.name_zh), std::pair("check", &fault.check),
        std::pair("check_zh", &fault.check_zh)})
    *text = cell(column);
  fault.doubts.assumed = marks_in("assumed");
  fault.doubts.contradicted = marks_in("contradicted");
  if (fault.name.empty()) refuse("name", "a name");
  return fault;
}

/// A panel text or a code with two meanings could not be explained.
class KnownFaults {
 public:
  KnownFaults(std::string_view file, std::vector<Error>& errors) : file_(file), errors_(&errors) {}

  bool add(const Fault& fault, std::uint32_t line) {
    const auto code = fault.code ? formatted("0x{:04X}", *fault.code) : std::string();
    const auto& shown = fault.panel.empty() ? code : fault.panel;
    const auto [first, is_new] = lines_.emplace(std::tuple(code, fault.extra, fault.panel), line);
    if (is_new || shown.empty()) return true;
    errors_->push_back(file_error(
        file_, line, message("{} is in line {} as well", as_it_is(shown), first->second),
        "write all causes of a fault into one row, or tell the rows apart by code, extra or panel"));
    return false;
  }

 private:
  std::string_view file_;
  std::vector<Error>* errors_;
  std::map<std::tuple<std::string, std::string, std::string>, std::uint32_t> lines_;
};

}  // namespace

std::vector<Fault> read_faults(std::string_view csv, std::string_view file, std::vector<Error>& errors) {
  const auto table = read_csv(csv, file, errors);
  (void)od::TableColumns::find(table, kColumns, file, errors);
  std::vector<Fault> faults;
  constexpr std::string_view kNeeded[] = {"name"};
  if (!table.has_columns(kNeeded, file, errors)) return faults;
  KnownFaults known(file, errors);
  for (const auto& row : table.rows) {
    const auto before = errors.size();
    auto fault = read_fault(table, row, file, errors);
    if (errors.size() == before && known.add(fault, row.line)) faults.push_back(std::move(fault));
  }
  return faults;
}

Result<std::vector<Fault>> parse_faults(std::string_view csv, std::string_view file) {
  std::vector<Error> errors;
  auto faults = read_faults(csv, file, errors);
  if (!errors.empty()) return fail(std::move(errors.front()));
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
