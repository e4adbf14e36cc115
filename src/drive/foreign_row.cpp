// Numbers of a table of parameters: raw or in the unit, and what the data sheet says of them.
#include "drive/foreign_row.hpp"

#include <array>
#include <cmath>
#include <optional>

#include "base/csv.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "od/data_type.hpp"

namespace servoctl::drive {

const std::string_view kForeignRowHeader =
    "id,object,type,access,unit,scale,default,min,max,effect,enum,enum_zh,name,name_zh,group,assumed,note,note_zh";

std::string ForeignRow::csv() const {
  std::string out;
  bool first = true;
  for (const auto* cell : {&id, &object, &type, &access, &unit, &scale, &standard, &low, &high, &effect,
                           &labels, &labels_zh, &name, &name_zh, &group, &assumed, &note, &note_zh}) {
    out += (first ? "" : ",") + csv_cell(*cell);
    first = false;
  }
  return out + "\n";
}

std::string text_of(const std::optional<od::NodeValue>& value) {
  return value && !value->plus_node_id ? od::to_string(value->value) : std::string();
}

namespace {

/// Up to here a double has every whole number.
constexpr double kMostExact = 9007199254740992.0;

std::optional<double> scale_of(const ForeignRow& row) {
  const auto scale = parse_real(row.scale);
  return scale && *scale != 1 && *scale > 0 ? scale : std::nullopt;
}

/// What one number of a scaled row shows.
enum class Shown : std::uint8_t { nothing, raw, in_unit };

Shown shown_by(const std::string& cell, const std::optional<od::NodeValue>* of_sheet, double scale) {
  if (cell.starts_with("0x") || cell.starts_with("0X")) return Shown::raw;
  const auto number = parse_real(cell);
  if (!number) return Shown::nothing;
  if (cell.find('.') != std::string::npos) return Shown::in_unit;
  const auto raw = of_sheet == nullptr ? std::optional<double>() : parse_real(text_of(*of_sheet));
  if (!raw || *number == 0) return Shown::nothing;
  if (*number == *raw) return Shown::raw;
  return std::abs(*number / scale - *raw) < 1e-6 ? Shown::in_unit : Shown::nothing;
}

/// The lines that prove what the numbers are; 0: none does.
struct Proofs {
  std::uint32_t raw = 0;
  std::uint32_t in_unit = 0;
  std::uint32_t scaled = 0;  ///< The first with numbers and a scale.
};

Proofs proofs_in(const std::vector<ForeignRow>& rows) {
  Proofs out;
  const auto note = [](std::uint32_t& line, std::uint32_t at) {
    if (line == 0) line = at;
  };
  for (const auto& row : rows) {
    const auto scale = scale_of(row);
    if (!scale) continue;
    if (!(row.standard + row.low + row.high).empty()) note(out.scaled, row.line);
    const auto* entry = row.entry;
    for (const auto shown :
         {shown_by(row.standard, entry == nullptr ? nullptr : &entry->default_value, *scale),
          shown_by(row.low, entry == nullptr ? nullptr : &entry->low, *scale),
          shown_by(row.high, entry == nullptr ? nullptr : &entry->high, *scale)}) {
      if (shown == Shown::raw) note(out.raw, row.line);
      if (shown == Shown::in_unit) note(out.in_unit, row.line);
    }
  }
  return out;
}

void make_raw(ForeignRow& row, std::string_view file, std::vector<Error>& errors) {
  const auto scale = scale_of(row);
  if (!scale) return;
  for (auto* cell : {&row.standard, &row.low, &row.high}) {
    const auto shown = parse_real(*cell);
    if (!shown) continue;
    const auto raw = *shown / *scale;
    if (std::abs(raw) < kMostExact && std::abs(raw - std::round(raw)) < 1e-6)
      *cell = formatted("{}", std::llround(raw));
    else
      errors.push_back(file_error(
          file, row.line,
          formatted("{}: {} {} is no whole number of steps of {}", row.id, *cell, row.unit, row.scale),
          "correct the number or the scale"));
  }
}

/// Numbers that may be raw or in the unit; 0 is both.
void mark_assumed(ForeignRow& row) {
  if (!scale_of(row)) return;
  for (const auto& [field, cell] :
       {std::pair{"default", &row.standard}, {"min", &row.low}, {"max", &row.high}})
    if (const auto number = parse_real(*cell); number && *number != 0) append(row.assumed, field, ";");
}

}  // namespace

void settle_numbers(std::vector<ForeignRow>& rows, std::string_view file, std::vector<Error>& errors,
                    std::vector<std::string>& notices) {
  const auto proofs = proofs_in(rows);
  if (proofs.raw != 0 && proofs.in_unit != 0) {
    errors.push_back(file_error(
        file, proofs.in_unit,
        formatted("default or limits are numbers in the unit here, but raw numbers in line {}", proofs.raw),
        "write all numbers of the table in the unit, or all raw; correct the scale if it is wrong"));
  } else if (proofs.in_unit != 0) {
    notices.push_back(
        formatted("{}:{}: default and limits are taken as numbers in the unit, as this line shows them; the "
                  "table of the family has raw ones",
                  file, proofs.in_unit));
    for (auto& row : rows) make_raw(row, file, errors);
  } else if (proofs.scaled != 0 && proofs.raw == 0 && errors.empty()) {
    for (auto& row : rows) mark_assumed(row);
    notices.push_back(
        formatted("{}:{}: default and limits are taken as raw numbers (value = raw × scale): no line "
                  "of the table proves it; compare them with the manual",
                  file, proofs.scaled));
  }
}

void add_from_sheet(ForeignRow& row, std::string_view file, std::vector<std::string>& notices) {
  if (row.entry == nullptr) {
    if (row.access.empty()) row.access = "rw";
    if (!row.type.empty()) return;
    row.type = "i32";
    append(row.assumed, "type", ";");
    return;
  }
  const auto& entry = *row.entry;
  const auto use_sheet = [&](std::string& cell, std::string_view of_sheet) {
    notices.push_back(formatted("{}:{}: {} is {} here and {} in the data sheet: the data sheet is used", file,
                                row.line, row.id, cell, of_sheet));
    cell = of_sheet;
  };
  const auto own = od::parse_data_type(row.type);
  if (own && *own != entry.type) use_sheet(row.type, od::name(entry.type));
  if (row.type.empty()) row.type = od::name(entry.type);
  if ((row.access == "rw" || row.access == "wo") && !od::writable(entry.access))
    use_sheet(row.access, od::name(entry.access));
  if (row.access.empty()) row.access = od::name(entry.access);
  if (row.standard.empty()) row.standard = text_of(entry.default_value);
  if (row.low.empty()) row.low = text_of(entry.low);
  if (row.high.empty()) row.high = text_of(entry.high);
}

}  // namespace servoctl::drive
