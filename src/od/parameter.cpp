#include "od/parameter.hpp"

#include <array>
#include <unordered_set>

#include "base/format.hpp"
#include "base/text.hpp"
#include "od/table_row.hpp"

namespace servoctl::od {
namespace {

enum Column : std::size_t {
  kId,
  kObject,
  kType,
  kAccess,
  kUnit,
  kScale,
  kEncoding,
  kDefault,
  kMin,
  kMax,
  kEffect,
  kEnum,
  kEnumZh,
  kName,
  kNameZh,
  kGroup,
  kFlags,
  kAssumed,
  kContradicted,
  kNote,
  kNoteZh,
  kLine
};
constexpr auto kColumns = std::to_array<std::string_view>(
    {"id",    "object",  "type",         "access", "unit",    "scale", "encoding", "default",
     "min",   "max",     "effect",       "enum",   "enum_zh", "name",  "name_zh",  "group",
     "flags", "assumed", "contradicted", "note",   "note_zh", "line"});

constexpr std::array<std::string_view, 4> kNeeded{"id", "type", "access", "name"};
constexpr std::string_view kTypes =
    "bool, i8, i16, i24, i32, i64, u8, u16, u24, u32, u64, f32, f64, string, bytes, domain or time";

std::optional<Access> parse_access(std::string_view text) {
  for (const auto access : {Access::ro, Access::rw, Access::wo, Access::constant})
    if (name(access) == text) return access;
  return std::nullopt;
}

void read_flags(TableRow& row, Parameter& out) {
  for (const auto flag : split(row.cell(kFlags), ' ')) {
    if (flag == "command") {
      out.command = true;
    } else if (flag == "volatile") {
      out.is_volatile = true;
    } else if (flag.starts_with("mirror=")) {
      out.mirror = parse_object_address(flag.substr(7));
      if (!out.mirror) row.refuse(kFlags, "flags with an object after mirror=");
    } else if (!flag.empty()) {
      row.refuse(kFlags, "made of command, volatile and mirror=OBJECT");
    }
  }
}

void read_limits(TableRow& row, Parameter& out) {
  out.default_value = row.value(kDefault, out.type);
  out.min = row.value(kMin, out.type);
  out.max = row.value(kMax, out.type);
  if (out.min && out.max && compare_numbers(*out.min, *out.max) > 0)
    return row.refuse(message("{}: min is above max", out.id));
  if (!out.default_value) return;
  const auto standard = to_string(*out.default_value);
  const Message hint = "correct the default, the limit or the scale";
  if (out.min && compare_numbers(*out.default_value, *out.min) < 0)
    row.refuse(message("{}: the default {} is below the minimum {} (raw numbers)", out.id, standard,
                       to_string(*out.min)),
               hint);
  if (out.max && compare_numbers(*out.default_value, *out.max) > 0)
    row.refuse(message("{}: the default {} is above the maximum {} (raw numbers)", out.id, standard,
                       to_string(*out.max)),
               hint);
}

Parameter read_row(TableRow& row) {
  Parameter out;
  out.id = std::string(row.cell(kId));
  if (out.id.empty()) row.refuse("a parameter without id");
  out.object = row.object(kObject);
  const auto type = parse_data_type(row.cell(kType));
  out.type = type.value_or(out.type);
  if (!type) row.refuse(kType, message("a data type: {}", kTypes));
  if (const auto access = parse_access(row.cell(kAccess)))
    out.access = *access;
  else
    row.refuse(kAccess, "ro, rw, wo or const");
  out.unit = std::string(row.cell(kUnit));
  out.scale = row.scale(kScale);
  out.encoding = row.encoding(kEncoding);
  if (type) read_limits(row, out);
  out.effect = row.effect(kEffect);
  out.labels = row.labels(kEnum, kEnumZh);
  out.name = std::string(row.cell(kName));
  if (out.name.empty()) row.refuse(message("{} has no name", out.id));
  out.name_zh = std::string(row.cell(kNameZh));
  out.group = std::string(row.cell(kGroup));
  read_flags(row, out);
  out.doubts = row.doubts(kAssumed, kContradicted);
  out.note = std::string(row.cell(kNote));
  out.note_zh = std::string(row.cell(kNoteZh));
  out.line = row.number(kLine);
  return out;
}

}  // namespace

std::vector<Parameter> read_parameters(std::string_view csv, std::string_view file,
                                       std::vector<Error>& errors) {
  const auto table = read_csv(csv, file, errors);
  const auto columns = TableColumns::find(table, kColumns, file, errors);
  std::vector<Parameter> out;
  if (!table.has_columns(kNeeded, file, errors)) return out;
  out.reserve(table.rows.size());
  std::unordered_set<std::string> ids;
  std::unordered_set<ObjectAddress> objects;
  for (const auto& cells : table.rows) {
    TableRow row(cells, columns, kColumns, file);
    auto parameter = read_row(row);
    parameter.file_line = cells.line;
    if (!ids.insert(lower(parameter.id)).second) row.refuse(message("{} appears twice", parameter.id));
    if (parameter.object && !objects.insert(*parameter.object).second)
      row.refuse(message("{}: object {} belongs to another parameter as well", parameter.id,
                         to_string(*parameter.object)));
    errors.insert(errors.end(), row.errors().begin(), row.errors().end());
    if (row.errors().empty()) out.push_back(std::move(parameter));
  }
  return out;
}

Result<std::vector<Parameter>> parse_parameters(std::string_view csv, std::string_view file) {
  std::vector<Error> errors;
  auto out = read_parameters(csv, file, errors);
  if (!errors.empty()) return fail(std::move(errors.front()));
  return out;
}

}  // namespace servoctl::od
