#include "settings/address_plan.hpp"

#include <algorithm>

#include "base/csv.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/node_id.hpp"
#include "drive/bitrate.hpp"

namespace servoctl::settings {
namespace {

constexpr std::string_view kNode = "node";
constexpr std::string_view kNew = "new";
constexpr std::string_view kFamily = "family";
constexpr std::string_view kSerial = "serial";
constexpr std::string_view kBitrate = "bitrate";

class PlanReader {
 public:
  PlanReader(const CsvTable& table, std::string_view file) : table_(&table), file_(file) {}

  Result<std::vector<AddressRow>> read() {
    for (const auto& column : table_->columns)
      if (column != kNode && column != kNew && column != kFamily && column != kSerial && column != kBitrate)
        return fail(file_error(file_, 1, message("unknown column '{}'", as_it_is(column)),
                               "a plan has the columns node,new and, where wanted, family,serial,bitrate"));
    if (!has(kNode) || !has(kNew))
      return fail(file_error(file_, 1, "the columns node and new are needed", "node,new"));
    std::vector<AddressRow> out;
    for (const auto& row : table_->rows) {
      const auto read = read_row(row);
      if (!read) return fail(read.error());
      out.push_back(*read);
    }
    if (out.empty())
      return fail(Errc::file, message("{}: no drive stands in it", as_it_is(file_)), "node,new");
    if (const auto once = each_once(out); !once) return fail(once.error());
    return out;
  }

 private:
  bool has(std::string_view column) const { return table_->column(column) < table_->columns.size(); }
  std::string_view cell(const CsvTable::Row& row, std::string_view column) const {
    const auto at = table_->column(column);
    return at < row.cells.size() ? trim(row.cells[at]) : std::string_view();
  }

  Result<AddressRow> read_row(const CsvTable::Row& row) const {
    AddressRow out;
    out.line = row.line;
    for (const auto& [column, place] : {std::pair(kNode, &out.node), std::pair(kNew, &out.to)}) {
      const auto number = parse_integer(cell(row, column));
      const auto node = number ? number->as_unsigned() : std::nullopt;
      if (!node || *node < canopen::kFirstNode || *node > canopen::kLastNode)
        return fail(file_error(file_, row.line, message("'{}' is not a node-ID", as_it_is(cell(row, column))),
                               "node-IDs are 1 to 127"));
      *place = static_cast<std::uint8_t>(*node);
    }
    out.family = cell(row, kFamily);
    if (const auto text = cell(row, kSerial); !text.empty()) {
      const auto number = parse_integer(text);
      const auto serial = number ? number->as_unsigned() : std::nullopt;
      if (!serial || *serial > 0xFFFF'FFFFU)
        return fail(file_error(file_, row.line, message("'{}' is not a serial number", as_it_is(text)),
                               "1018h:04 as `info` shows it"));
      out.serial = static_cast<std::uint32_t>(*serial);
    }
    if (const auto text = cell(row, kBitrate); !text.empty()) {
      const auto bitrate = drive::parse_bitrate(text);
      if (!bitrate) return fail(file_error(file_, row.line, bitrate.error().message, bitrate.error().hint));
      out.bitrate = *bitrate;
    }
    return out;
  }

  Result<void> each_once(std::span<const AddressRow> rows) const {
    std::set<std::uint8_t> from;
    std::set<std::uint8_t> to;
    std::optional<std::uint32_t> bitrate;
    for (const auto& row : rows) {
      if (!from.insert(row.node).second)
        return fail(file_error(file_, row.line, message("node {} appears twice", row.node)));
      if (!to.insert(row.to).second)
        return fail(file_error(file_, row.line, message("two drives are to be node {}", row.to)));
      if (!bitrate) bitrate = row.bitrate;
      if (row.bitrate && row.bitrate != bitrate)
        return fail(file_error(file_, row.line, "the drives of a bus have one bitrate, and the plan has two",
                               "the same bitrate in each row that has one"));
    }
    return {};
  }

  const CsvTable* table_;
  std::string_view file_;
};

/// Where the drives of a plan are, step by step.
class Renumbering {
 public:
  Renumbering(std::span<const AddressRow> rows, const std::set<std::uint8_t>& taken)
      : rows_(rows), taken_(taken) {
    for (const auto& row : rows) {
      at_.push_back(row.node);
      taken_.erase(row.node);
    }
  }

  Result<std::vector<AddressStep>> order() {
    for (const auto& row : rows_)
      if (taken_.count(row.to) > 0)
        return fail(drive_error(Errc::refused, row.node,
                                message("it is to be node {}, and that node-ID is taken", row.to),
                                "nothing was written; `scan` shows who is there"));
    while (const auto next = waiting()) {
      if (const auto moves = movable()) {
        move(*moves, rows_[*moves].to);
        continue;
      }
      const auto aside = free_node();
      if (!aside)
        return fail(drive_error(Errc::refused, at_[*next],
                                "no node-ID is free to which it could step aside for a while",
                                "take a drive off the bus"));
      move(*next, *aside);
    }
    return std::move(steps_);
  }

 private:
  std::optional<std::size_t> waiting() const {
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (at_[i] != rows_[i].to) return i;
    return std::nullopt;
  }
  bool is_free(std::uint8_t node) const {
    return taken_.count(node) == 0 && std::find(at_.begin(), at_.end(), node) == at_.end();
  }
  std::optional<std::size_t> movable() const {
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (at_[i] != rows_[i].to && is_free(rows_[i].to)) return i;
    return std::nullopt;
  }
  /// The highest that nobody has nor is to have.
  std::optional<std::uint8_t> free_node() const {
    for (std::uint8_t node = canopen::kLastNode; node >= canopen::kFirstNode; --node) {
      const bool wanted =
          std::any_of(rows_.begin(), rows_.end(), [&](const AddressRow& row) { return row.to == node; });
      if (is_free(node) && !wanted) return node;
    }
    return std::nullopt;
  }
  void move(std::size_t row, std::uint8_t to) {
    steps_.push_back({row, at_[row], to});
    at_[row] = to;
  }

  std::span<const AddressRow> rows_;
  std::set<std::uint8_t> taken_;
  std::vector<std::uint8_t> at_;
  std::vector<AddressStep> steps_;
};

}  // namespace

Result<std::vector<AddressRow>> parse_address_plan(std::string_view csv, std::string_view file) {
  const auto table = parse_csv(csv, file);
  if (!table) return fail(table.error());
  return PlanReader(*table, file).read();
}

Result<std::vector<AddressStep>> order_address_steps(std::span<const AddressRow> rows,
                                                     const std::set<std::uint8_t>& taken) {
  return Renumbering(rows, taken).order();
}

std::optional<std::uint32_t> bitrate_of(std::span<const AddressRow> rows) {
  const auto row = std::ranges::find_if(rows, [](const AddressRow& one) { return one.bitrate.has_value(); });
  return row == rows.end() ? std::nullopt : row->bitrate;
}

std::string question_address_plan(std::span<const AddressRow> rows, std::size_t steps,
                                  const std::string& then) {
  const auto bitrate = bitrate_of(rows);
  if (!bitrate)
    return formatted("Re-address {} drives in {} steps? Each one is restarted.", rows.size(), steps);
  const auto speed = drive::bitrate_text(*bitrate);
  const auto changed =
      std::ranges::count_if(rows, [](const AddressRow& one) { return one.bitrate.has_value(); });
  auto out = steps == 0
                 ? formatted("Write a bitrate of {} to {} drives, for their next start?", speed, changed)
                 : formatted(
                       "Re-address {} drives in {} steps, each restarted, and then write a bitrate of {} to "
                       "{} of them, for their next start?",
                       rows.size(), steps, speed, changed);
  return then.empty() ? out : formatted("{} If so, {}.", out, then);
}

}  // namespace servoctl::settings
