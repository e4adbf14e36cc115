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

/// A number of the table and that of the data sheet.
struct SheetNumber {
  std::string_view field;
  std::string* cell = nullptr;
  std::optional<od::NodeValue> of_sheet;
  int wider = 0;  ///< -1, 1: a lower, a higher limit is wider; 0: a default.
};

std::array<SheetNumber, 3> numbers_of(ForeignRow& row) {
  const auto* entry = row.entry;
  const auto none = std::optional<od::NodeValue>();
  return {SheetNumber{"default", &row.standard, entry == nullptr ? none : entry->default_value, 0},
          SheetNumber{"min", &row.low, entry == nullptr ? none : entry->low, -1},
          SheetNumber{"max", &row.high, entry == nullptr ? none : entry->high, 1}};
}

/// What one number of a scaled row shows.
enum class Shown : std::uint8_t { nothing, raw, in_unit };

Shown shown_by(const SheetNumber& one, double scale) {
  const auto number = parse_real(*one.cell);
  // `0x190`, `190h`
  if (!number) return parse_integer(*one.cell) ? Shown::raw : Shown::nothing;
  if (one.cell->find('.') != std::string::npos) return Shown::in_unit;
  const auto raw = parse_real(text_of(one.of_sheet));
  if (!raw || *number == 0) return Shown::nothing;
  const auto in_unit = *number / scale;
  if (*number != *raw) return std::abs(in_unit - *raw) < 1e-6 ? Shown::in_unit : Shown::nothing;
  // A limit may be equal by chance where it would be a narrower one in the unit.
  const bool is_chance = (one.wider < 0 && in_unit > *raw) || (one.wider > 0 && in_unit < *raw);
  return is_chance ? Shown::nothing : Shown::raw;
}

/// The lines that prove what the numbers are; 0: none does.
struct Proofs {
  std::uint32_t raw = 0;
  std::uint32_t in_unit = 0;
  std::uint32_t open = 0;  ///< The first with a scale and numbers that proves nothing by itself; 0 is both.
};

Proofs proofs_in(std::vector<ForeignRow>& rows) {
  Proofs out;
  const auto note = [](std::uint32_t& line, std::uint32_t at) {
    if (line == 0) line = at;
  };
  for (auto& row : rows) {
    const auto scale = scale_of(row);
    if (!scale) continue;
    bool is_open = false;
    bool is_proven = false;
    for (const auto& one : numbers_of(row)) {
      const auto shown = shown_by(one, *scale);
      if (shown == Shown::raw) note(out.raw, row.line);
      if (shown == Shown::in_unit) note(out.in_unit, row.line);
      is_proven = is_proven || shown != Shown::nothing;
      is_open = is_open || parse_real(*one.cell).value_or(0) != 0;
    }
    if (is_open && !is_proven) note(out.open, row.line);
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
      errors.push_back(file_error(file, row.line,
                                  message("{}: {} {} is no whole number of steps of {}", as_it_is(row.id),
                                          as_it_is(*cell), as_it_is(row.unit), as_it_is(row.scale)),
                                  "correct the number or the scale"));
  }
}

/// Numbers that may be raw or in the unit; 0 is both.
void mark_assumed(ForeignRow& row) {
  if (!scale_of(row)) return;
  for (const auto& one : numbers_of(row))
    if (parse_real(*one.cell).value_or(0) != 0) append(row.assumed, one.field, ";");
}

/// A number that contradicts the data sheet: another default, or a wider limit.
void compare_with_sheet(ForeignRow& row, std::string_view file, std::vector<Error>& errors,
                        std::vector<Message>& notices) {
  const auto scale = scale_of(row);
  for (const auto& one : numbers_of(row)) {
    const auto own = od::parse_value(row.entry->type, *one.cell);
    const auto sheet = text_of(one.of_sheet);
    if (!own || sheet.empty()) continue;
    const auto order = od::compare_numbers(*own, one.of_sheet->value);
    if (order == 0 || (one.wider != 0 && order != one.wider)) continue;
    if (scale) {
      errors.push_back(file_error(
          file, row.line,
          message("{}: {} is {} here and {} in the data sheet (raw numbers, by the scale {})",
                  as_it_is(row.id), as_it_is(one.field), as_it_is(*one.cell), as_it_is(sheet),
                  as_it_is(row.scale)),
          message("correct the number or the scale, or leave the cell empty; the data sheet has {}, which is "
                  "{:.10g} {} by this scale",
                  as_it_is(sheet), od::to_double(one.of_sheet->value) * *scale, as_it_is(row.unit))));
    } else if (one.wider == 0) {
      notices.push_back(message("{}:{}: {}: default is {} here and {} in the data sheet: the table is used",
                                as_it_is(file), row.line, as_it_is(row.id), as_it_is(*one.cell),
                                as_it_is(sheet)));
    } else {
      notices.push_back(message("{}:{}: {}: {} is {} here and {} in the data sheet: the data sheet is used",
                                as_it_is(file), row.line, as_it_is(row.id), as_it_is(one.field),
                                as_it_is(*one.cell), as_it_is(sheet)));
      *one.cell = sheet;
    }
  }
}

}  // namespace

bool settle_numbers(std::vector<ForeignRow>& rows, std::string_view file, std::vector<Error>& errors,
                    std::vector<Message>& notices) {
  const auto proofs = proofs_in(rows);
  if (proofs.raw != 0 && proofs.in_unit != 0) {
    errors.push_back(file_error(
        file, proofs.in_unit,
        message("default or limits are numbers in the unit here, but raw numbers in line {}", proofs.raw),
        "write all numbers of the table in the unit, or all raw; correct the scale if it is wrong"));
    return false;
  }
  if (proofs.in_unit != 0) {
    notices.push_back(
        message("{}:{}: default and limits are taken as numbers in the unit, as this line shows them; the "
                "table of the family has raw ones",
                as_it_is(file), proofs.in_unit));
    for (auto& row : rows) make_raw(row, file, errors);
  } else if (proofs.open != 0 && proofs.raw != 0) {
    notices.push_back(
        message("{}:{}: default and limits are taken as raw numbers (value = raw × scale), as line {} shows "
                "them; compare them with the manual",
                as_it_is(file), proofs.open, proofs.raw));
  } else if (proofs.open != 0 && errors.empty()) {
    for (auto& row : rows) mark_assumed(row);
    notices.push_back(
        message("{}:{}: default and limits are taken as raw numbers (value = raw × scale): no line "
                "of the table proves it; compare them with the manual",
                as_it_is(file), proofs.open));
  }
  return true;
}

void add_from_sheet(ForeignRow& row, std::string_view file, std::vector<Error>& errors,
                    std::vector<Message>& notices) {
  if (row.entry == nullptr) {
    if (row.access.empty()) row.access = "rw";
    if (!row.type.empty()) return;
    row.type = "i32";
    append(row.assumed, "type", ";");
    return;
  }
  const auto& entry = *row.entry;
  const auto use_sheet = [&](std::string& cell, std::string_view of_sheet) {
    notices.push_back(message("{}:{}: {} is {} here and {} in the data sheet: the data sheet is used",
                              as_it_is(file), row.line, as_it_is(row.id), as_it_is(cell),
                              as_it_is(of_sheet)));
    cell = of_sheet;
  };
  const auto own = od::parse_data_type(row.type);
  if (own && *own != entry.type) use_sheet(row.type, od::name(entry.type));
  if (row.type.empty()) row.type = od::name(entry.type);
  for (const auto access : {od::Access::ro, od::Access::rw, od::Access::wo, od::Access::constant})
    if (row.access == od::name(access) && (od::writable(access) != od::writable(entry.access) ||
                                           od::readable(access) != od::readable(entry.access)))
      use_sheet(row.access, od::name(entry.access));
  if (row.access.empty()) row.access = od::name(entry.access);
  compare_with_sheet(row, file, errors, notices);
  if (row.standard.empty()) row.standard = text_of(entry.default_value);
  if (row.low.empty()) row.low = text_of(entry.low);
  if (row.high.empty()) row.high = text_of(entry.high);
}

}  // namespace servoctl::drive
