
#include "base/csv.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/cob_id.hpp"
#include "settings/backup_formats.hpp"
#include "show/reading.hpp"

namespace servoctl::settings {
namespace {

/// Why a value that the drive held is not to be put back.
constexpr std::string_view kOutside = "outside of its limits ";

/// Number and unit of a value; the raw number where no unit says what a scaled one would be.
struct Cells {
  std::string value;
  std::string unit;
};

Cells cells_of(const drive::Meaning& meaning, od::DataType type, const Bytes& bytes) {
  const auto value = od::decode(type, bytes);
  if (!value || od::size_of(type).value_or(8) > 8) return {};
  // In another encoding, or by what cannot be seen, it would be another text when it is read.
  if (const auto* string = std::get_if<std::string>(&*value); string != nullptr && !fits_a_line(*string))
    return {};
  const bool text = std::holds_alternative<std::string>(*value) || std::holds_alternative<Bytes>(*value);
  if (text || (meaning.scale == 1 && meaning.encoding == od::Encoding::plain))
    return {od::to_string(*value), std::string(text ? "" : meaning.unit)};
  if (meaning.unit.empty() && meaning.encoding == od::Encoding::plain) return {od::to_string(*value), {}};
  return {plain_number(drive::scaled(meaning, *value), 12), std::string(meaning.unit)};
}

std::string row_text(const drive::Profile& profile, const Backup& backup, const Backup::Entry& entry) {
  const auto target = drive::target_at(&profile, entry.object);
  Cells cells;
  auto left_out = entry.left_out;
  if (entry.bytes) {
    const auto meaning = drive::fitted(drive::meaning(target, backup.identity.node), entry.bytes->size());
    cells = cells_of(meaning, entry.type, *entry.bytes);
    const auto range = range_missed(profile, backup.identity.node, entry.object, *entry.bytes);
    if (!range.empty()) left_out = formatted("{}{}", kOutside, range);
  }
  return formatted("{},0x{:04X},0x{:02X},{},{},{},{},{},{},{}\n", backup.identity.node, entry.object.index,
                   entry.object.sub, csv_cell(entry.id), csv_cell(entry.name), od::name(entry.type),
                   csv_cell(cells.value), csv_cell(cells.unit),
                   entry.bytes ? "hex:" + to_hex(*entry.bytes) : std::string(), csv_cell(left_out));
}

/// Reads the rows of a table.
class CsvBackupReader {
 public:
  CsvBackupReader(const CsvTable& table, const std::string& file, const drive::Profile& profile,
                  std::uint8_t node)
      : table_(&table), file_(&file), profile_(&profile), node_(node) {}

  Result<Backup> read() {
    if (!has("index") || (!has("raw") && !has("value")))
      return fail(Errc::file,
                  message("{}: a table of settings has the columns index and raw or value", as_it_is(*file_)),
                  "`backup --format csv` writes one");
    Backup out;
    for (const auto& row : table_->rows) {
      row_ = &row;
      Backup::Entry entry;
      entry.line = row.line;
      if (const auto same = take_node(out.identity.node); !same) return fail(same.error());
      if (cell("raw").empty() && cell("value").empty() && !cell("left_out").empty()) continue;
      if (const auto read = read_row(entry); !read) return fail(read.error());
      out.entries.push_back(std::move(entry));
    }
    return out;
  }

 private:
  bool has(std::string_view column) const { return table_->column(column) < table_->columns.size(); }
  std::string_view cell(std::string_view column) const {
    return has(column) ? trim(row_->cells[table_->column(column)]) : std::string_view();
  }

  /// All rows are of one drive.
  Result<void> take_node(std::uint8_t& node) const {
    if (cell("node").empty()) return {};
    const auto number = parse_digits(cell("node"), 10);
    if (!number || *number < canopen::kFirstNode || *number > canopen::kLastNode)
      return refuse(message("'{}' is not a node-ID", as_it_is(clip(cell("node"), 40))), "1 to 127");
    if (node != 0 && node != *number)
      return refuse(message("is of node {}, the rows before are of node {}", *number, node),
                    "a table holds the settings of one drive");
    node = static_cast<std::uint8_t>(*number);
    return {};
  }

  Result<void> read_row(Backup::Entry& entry) const {
    auto written = std::string(cell("index"));
    if (!cell("sub").empty()) written += formatted(":{}", cell("sub"));
    const auto object = parse_object_address(written);
    if (!object)
      return refuse(message("'{}' is not an index and sub-index", as_it_is(written)), "0x2005,0x01");
    entry.object = *object;
    const auto target = drive::target_at(profile_, *object);
    if (cell("raw").empty() && cell("value").empty()) {
      entry.left_out = "no value";
      return {};
    }
    if (cell("left_out").starts_with(kOutside)) {
      entry.left_out = cell("left_out");
      return {};
    }
    if (cell("raw").empty()) return take_value(entry, target);
    const auto raw = cell("raw");
    entry.bytes = parse_hex_bytes(starts_with_nocase(raw, "hex:") ? raw.substr(4) : raw);
    if (!entry.bytes)
      return refuse(message("raw: '{}' is not hexadecimal bytes", as_it_is(clip(raw, 40))), "hex:58 02");
    return check_value(entry, target);
  }

  std::string quantity() const {
    return cell("unit").empty() ? std::string(cell("value"))
                                : formatted("{} {}", cell("value"), cell("unit"));
  }

  Result<Bytes> bytes_of(const drive::Meaning& meaning) const {
    const auto value = drive::parse_quantity(meaning, quantity());
    if (!value) return fail(value.error());
    return od::encode(meaning.type, *value);
  }

  Result<void> take_value(Backup::Entry& entry, const drive::Target& target) const {
    const auto meaning = drive::meaning(target, node_);
    auto type = od::parse_data_type(cell("type"));
    if (!meaning.size_known && !type)
      return refuse("the manual does not state the length of this object",
                    "give its type (column type: i16, i32 …), or raw bytes");
    auto sized = type ? drive::fitted(meaning, od::size_of(*type).value_or(0)) : meaning;
    auto bytes = bytes_of(sized);
    if (!bytes) return refuse(message("value: {}", bytes.error().message), bytes.error().hint);
    entry.bytes = std::move(*bytes);
    return {};
  }

  /// Who edits a table changes one of the two cells, and may not know of the other.
  Result<void> check_value(const Backup::Entry& entry, const drive::Target& target) const {
    if (cell("value").empty()) return {};
    const auto meaning = drive::fitted(drive::meaning(target, node_), entry.bytes->size());
    const auto type = show::type_of({node_, target, {}, *entry.bytes}, *entry.bytes);
    const auto cells = cells_of(meaning, type, *entry.bytes);
    if (cells.value.empty() || (trim(cells.value) == cell("value") && cells.unit == cell("unit"))) return {};
    const auto bytes = bytes_of(meaning);
    if (bytes && *bytes == *entry.bytes) return {};
    return refuse(message("value {} and raw {} ({}) differ", as_it_is(quantity()), as_it_is(cell("raw")),
                          as_it_is(cells.value)),
                  "correct one of them, and empty the other");
  }

  tl::unexpected<Error> refuse(const Message& what, Message hint) const {
    auto error =
        fail(Errc::file, message("{}:{}: {}", as_it_is(*file_), row_->line, what), std::move(hint)).value();
    error.line = row_->line;
    return fail(std::move(error));
  }

  const CsvTable* table_;
  const std::string* file_;
  const drive::Profile* profile_;
  std::uint8_t node_;
  const CsvTable::Row* row_ = nullptr;
};

}  // namespace

std::string csv_text(const drive::Profile& profile, const Backup& backup) {
  std::string out = "node,index,sub,parameter,name,type,value,unit,raw,left_out\n";
  for (const auto& entry : backup.entries) out += row_text(profile, backup, entry);
  return out;
}

Result<Backup> read_csv_backup(std::string_view text, const std::string& file, const drive::Profile& profile,
                               std::uint8_t node) {
  const auto table = parse_csv(text, file);
  if (!table) return fail(table.error());
  return CsvBackupReader(*table, file, profile, node).read();
}

}  // namespace servoctl::settings
