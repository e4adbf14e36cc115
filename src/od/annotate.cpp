#include <fmt/format.h>
#include <array>

#include "base/number.hpp"
#include "base/text.hpp"
#include "od/parameter.hpp"
#include "od/table_row.hpp"

namespace servoctl::od {
namespace {

enum Column : std::size_t {
  kObject,
  kUnit,
  kScale,
  kEncoding,
  kEffect,
  kEnum,
  kEnumZh,
  kNameZh,
  kFlags,
  kAssumed,
  kContradicted,
  kNote,
  kNoteZh,
  kLine
};
constexpr auto kColumns = std::to_array<std::string_view>({"object", "unit", "scale", "encoding", "effect",
                                                           "enum", "enum_zh", "name_zh", "flags", "assumed",
                                                           "contradicted", "note", "note_zh", "line"});

/// The number in `least=1000`.
std::optional<std::uint64_t> least_of(std::string_view flag) {
  constexpr std::string_view kKey = "least=";
  return flag.starts_with(kKey) ? parse_digits(flag.substr(kKey.size()), 10) : std::nullopt;
}

void read_flags(TableRow& row, Entry& entry) {
  bool rpdo = false;
  bool tpdo = false;
  for (const auto flag : split(row.cell(kFlags), ' ')) {
    if (flag == "command")
      entry.command = true;
    else if (flag == "volatile")
      entry.is_volatile = true;
    else if (flag == "rpdo")
      rpdo = true;
    else if (flag == "tpdo")
      tpdo = true;
    else if (const auto least = least_of(flag))
      entry.least = least;
    else if (!flag.empty())
      row.refuse(kFlags, "made of command, volatile, rpdo, tpdo and least=NUMBER");
  }
  if (rpdo || tpdo) entry.pdo = rpdo && tpdo ? PdoMapping::both : rpdo ? PdoMapping::rpdo : PdoMapping::tpdo;
}

void read_entry(TableRow& row, Entry& entry) {
  entry.unit = std::string(row.cell(kUnit));
  entry.scale = row.scale(kScale);
  entry.encoding = row.encoding(kEncoding);
  entry.effect = row.effect(kEffect);
  entry.labels = row.labels(kEnum, kEnumZh);
  entry.name_zh = std::string(row.cell(kNameZh));
  entry.doubts = row.doubts(kAssumed, kContradicted);
  entry.note = std::string(row.cell(kNote));
  entry.note_zh = std::string(row.cell(kNoteZh));
  entry.line = row.number(kLine);
  read_flags(row, entry);
}

/// `0x6099`: the name of an object of several entries, which has no place in the lines of these.
void name_object(TableRow& row, Object& object) {
  object.name_zh = std::string(row.cell(kNameZh));
  for (std::size_t column = kUnit; column < kColumns.size(); ++column)
    if (column != kNameZh && column != kLine && !row.cell(column).empty())
      row.refuse(column, "empty in the line of an object without a sub-index");
}

void read_row(TableRow& row, Dictionary& dictionary) {
  const auto address = row.object(kObject);
  auto* object = address ? dictionary.object(address->index) : nullptr;
  if (object != nullptr && object->entries.size() > 1 &&
      row.cell(kObject).find(':') == std::string_view::npos)
    return name_object(row, *object);
  auto* entry = address ? dictionary.find(*address) : nullptr;
  if (entry == nullptr)
    row.refuse(kObject, "an object of the dictionary");
  else
    read_entry(row, *entry);
}

}  // namespace

void annotate(Dictionary& dictionary, std::string_view csv, std::string_view file,
              std::vector<Error>& errors) {
  const auto table = read_csv(csv, file, errors);
  const auto columns = TableColumns::find(table, kColumns, file, errors);
  constexpr std::string_view kNeeded[] = {"object"};
  if (!table.has_columns(kNeeded, file, errors)) return;
  for (const auto& cells : table.rows) {
    TableRow row(cells, columns, kColumns, file);
    read_row(row, dictionary);
    errors.insert(errors.end(), row.errors().begin(), row.errors().end());
  }
}

Result<void> annotate(Dictionary& dictionary, std::string_view csv, std::string_view file) {
  std::vector<Error> errors;
  annotate(dictionary, csv, file, errors);
  if (!errors.empty()) return fail(std::move(errors.front()));
  return {};
}

}  // namespace servoctl::od
