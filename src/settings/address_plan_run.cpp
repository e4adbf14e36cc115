#include "settings/address_plan_run.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/checksum.hpp"
#include "base/file_lock.hpp"
#include "canopen/node_list.hpp"
#include "drive/bitrate.hpp"
#include "session/identify.hpp"
#include "session/scan.hpp"
#include "settings/address_journal.hpp"
#include "show/identity.hpp"

namespace servoctl::settings {
namespace {

namespace fs = std::filesystem;
using report::Show;
using report::Table;
using report::Value;
using session::Identity;

/// What came of one drive.
struct RowEnd {
  std::string result = "not reached";
  std::optional<std::uint32_t> serial;
};

class PlanRun {
 public:
  PlanRun(show::Desk& desk, std::string_view text, const fs::path& file, const AddressPlanOptions& options)
      : desk_(&desk),
        session_(desk.session),
        text_(text),
        file_(file),
        path_(address_journal_of(file)),
        options_(&options) {}

  Result<Value> run() {
    auto rows = parse_address_plan(text_, file_.string());
    if (!rows) return fail(rows.error());
    rows_ = std::move(*rows);
    ends_.resize(rows_.size());
    auto lock = desk_->dry_run ? Result<std::optional<FileLock>>(std::nullopt)
                               : FileLock::take(path_.string() + ".lock");
    if (!lock) return fail(lock.error());
    if (!desk_->dry_run && !*lock)
      return fail(Errc::refused, fmt::format("another servoctl is carrying out {}", file_.string()),
                  "wait until it ends, or find it with `ps`");
    if (const auto known = take_up(); !known) return fail(known.error());
    if (const auto looked = look(); !looked) return fail(looked.error());
    if (desk_->dry_run) return frames();
    if (nothing_to_do()) return answer();
    if (const auto agreed = ask(); !agreed) return fail(agreed.error());
    if (const auto done = carry_out(); !done) return fail(done.error());
    return answer();
  }

 private:
  Result<void> take_up() {
    const auto found = read_address_journal(path_);
    if (!found) return fail(found.error());
    if (*found && !options_->resume)
      return fail(Errc::refused, fmt::format("{} was interrupted", file_.string()),
                  "--resume continues it; `scan` shows where the drives are");
    if (!*found && options_->resume)
      return fail(Errc::usage, fmt::format("there is nothing to resume: {} does not exist", path_.string()),
                  "leave --resume out");
    journal_.checksum = checksum_of(text_);
    if (!*found) return {};
    if ((*found)->checksum != journal_.checksum || (*found)->drives.size() != rows_.size())
      return fail(Errc::refused, fmt::format("{} has changed since it was interrupted", file_.string()),
                  "resuming needs the plan as it was");
    journal_ = **found;
    return {};
  }

  Result<void> look() {
    if (options_->resume) return settle();
    const auto used = session::nodes_in_use(*session_, canopen::every_node_id());
    if (!used) return fail(used.error());
    std::set<std::uint8_t> taken;
    for (const auto& each : *used) taken.insert(each.first);
    auto steps = order_address_steps(rows_, taken);
    if (!steps) return fail(steps.error());
    journal_.steps = std::move(*steps);
    for (const auto& row : rows_) {
      auto change = plan_address(*desk_, row.node, {.node = row.to, .serial = row.serial});
      if (!change) return fail(with_row(row, change.error()));
      if (!row.bitrate) {
        // It keeps the one it has.
      } else if (const auto fits = plan_address(*desk_, row.node, {.bitrate = row.bitrate}); !fits) {
        return fail(with_row(row, fits.error()));
      }
      journal_.drives.push_back(change->identity);
      changes_.push_back(std::move(*change));
    }
    return {};
  }

  /// Whether the step that was under way was done: the drive is at one of its two ends.
  Result<void> settle() {
    if (!journal_.begun || journal_.done >= journal_.steps.size()) return {};
    const auto& step = journal_.steps[journal_.done];
    const std::uint8_t both[] = {step.from, step.to};
    const auto found = session::scan(*session_, both);
    if (!found) return fail(found.error());
    const auto is_at = [&](std::uint8_t node) {
      return std::any_of(found->begin(), found->end(), [&](const Identity& identity) {
        return identity.node == node && show::change_of(journal_.drives[step.row], identity).empty();
      });
    };
    if (is_at(step.from) && is_at(step.to))
      return fail(drive_error(Errc::refused, step.from,
                              fmt::format("it was on its way to node {}, and both answer now", step.to),
                              "`scan --long` shows both; make sure that only one of them is there"));
    if (!is_at(step.from) && !is_at(step.to))
      return fail(drive_error(Errc::timeout, step.from,
                              fmt::format("it was on its way to node {}, and is at neither", step.to),
                              "switch it off and on, and resume again"));
    if (is_at(step.to)) ++journal_.done;
    journal_.begun = false;
    return {};
  }

  static Error with_row(const AddressRow& row, Error error) {
    if (!error.node) error.node = row.node;
    error.message = fmt::format("line {}: {}", row.line, error.message);
    return error;
  }

  bool nothing_to_do() {
    if (options_->resume || !journal_.steps.empty() || has_bitrates()) return false;
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (!changes_[i].idle()) return false;
    for (std::size_t i = 0; i < rows_.size(); ++i) note(i, text_of(AddressEnd::nothing_to_do));
    return true;
  }

  bool has_bitrates() const {
    return std::any_of(rows_.begin(), rows_.end(),
                       [](const AddressRow& row) { return row.bitrate.has_value(); });
  }

  Table step_table() const {
    Table table;
    table.columns = {{"step"}, {"node"}, {"new_node", "new"}, {"remark"}};
    for (std::size_t i = journal_.done; i < journal_.steps.size(); ++i) {
      const auto& step = journal_.steps[i];
      const bool aside = step.to != rows_[step.row].to;
      table.rows.push_back({i + 1, step.from, step.to, aside ? Value("steps aside for a while") : Value()});
    }
    return table;
  }

  Result<Value> frames() {
    std::vector<AddressChange> sent;
    for (std::size_t i = 0; i < changes_.size(); ++i) {
      sent.push_back(changes_[i]);
      const auto goes_aside = std::count_if(journal_.steps.begin(), journal_.steps.end(),
                                            [&](const AddressStep& step) { return step.row == i; }) > 1;
      if (rows_[i].bitrate)
        desk_->notices.push_back(
            fmt::format("node {}: its bitrate is written at the end, when all have moved", rows_[i].to));
      if (goes_aside)
        desk_->notices.push_back(
            fmt::format("node {}: it steps aside to a free node-ID first, see the steps", rows_[i].node));
    }
    desk_->tell_value(Value(step_table()));
    return planned_address(*desk_, sent, options_->each.unlock);
  }

  Result<void> ask() const {
    desk_->tell_value(Value(step_table()));
    return desk_->confirm(fmt::format("Re-address {} drives in {} steps? Each one is restarted.",
                                      rows_.size(), journal_.steps.size() - journal_.done));
  }

  Result<void> carry_out() {
    if (const auto noted = write_address_journal(path_, journal_); !noted) return noted;
    const bool moved = move_all();
    const bool all = moved && set_bitrates();
    std::error_code ignored;
    const bool untouched = journal_.done == 0 && !journal_.begun;
    if (all || untouched)
      fs::remove(path_, ignored);
    else
      desk_->notices.push_back("the plan is not finished: --resume continues once the cause is removed");
    return {};
  }

  bool move_all() {
    for (std::size_t i = 0; i < journal_.done; ++i) note(journal_.steps[i].row, text_of(AddressEnd::moved));
    while (journal_.done < journal_.steps.size())
      if (!move_next()) return false;
    return true;
  }

  bool move_next() {
    const auto step = journal_.steps[journal_.done];
    const auto row = rows_[step.row];
    const std::uint8_t to[] = {step.to};
    auto change = plan_address(*desk_, step.from, {.node = step.to});
    if (change && !show::change_of(journal_.drives[step.row], change->identity).empty())
      change =
          fail(drive_error(Errc::refused, step.from, "another drive is there than when the plan was made",
                           "`scan --long` shows who is there"));
    if (!change) return stop(step.row, change.error());
    if (const auto free = refuse_taken(*session_, to, Duration::zero()); !free)
      return stop(step.row, free.error());
    journal_.begun = true;
    if (const auto noted = write_address_journal(path_, journal_); !noted)
      return stop(step.row, noted.error());
    const auto outcome = change_address(*desk_, *change, options_->each);
    note(step.row, text_of(outcome.end));
    if (outcome.end == AddressEnd::as_before) journal_.begun = false;
    if (outcome.end != AddressEnd::moved) return stop(step.row, outcome.error.value_or(waits(step)));
    if (outcome.error) desk_->errors.push_back(with_row(row, *outcome.error));
    journal_.begun = false;
    ++journal_.done;
    if (const auto noted = write_address_journal(path_, journal_); !noted)
      return stop(step.row, noted.error());
    return true;
  }

  static Error waits(const AddressStep& step) {
    return drive_error(
        Errc::negative, step.from,
        fmt::format("it is to be switched off and on before the next one moves: then it is node {}", step.to),
        "switch it off and on, then add --resume; --wait 5min waits for it");
  }

  bool stop(std::size_t row, Error error) {
    if (ends_[row].result == "not reached") note(row, "not moved; see the error");
    desk_->errors.push_back(with_row(rows_[row], std::move(error)));
    (void)write_address_journal(path_, journal_);
    return false;
  }

  /// Drives that stay where they are, with another bitrate at their next start.
  bool set_bitrates() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (!rows_[i].bitrate) {
        if (ends_[i].result == "not reached") note(i, text_of(AddressEnd::nothing_to_do));
        continue;
      }
      const auto change = plan_address(*desk_, rows_[i].to, {.bitrate = rows_[i].bitrate});
      if (!change) return stop(i, change.error());
      const auto outcome = change_address(*desk_, *change, options_->each);
      if (outcome.error) return stop(i, *outcome.error);
      note(i, outcome.end == AddressEnd::nothing_to_do
                  ? ends_[i].result
                  : fmt::format("{} from the next start", drive::bitrate_text(*rows_[i].bitrate)));
    }
    tell_bitrate();
    return true;
  }

  void tell_bitrate() {
    if (!has_bitrates()) return;
    const auto row = std::find_if(rows_.begin(), rows_.end(), [](const AddressRow& r) { return r.bitrate; });
    for (const auto& line : bitrate_steps(session_->url(), *row->bitrate)) desk_->notices.push_back(line);
  }

  void note(std::size_t row, std::string_view result) {
    ends_[row].result = result;
    ends_[row].serial = journal_.drives[row].serial;
  }

  Value answer() const {
    Table table;
    table.columns = {{"node"}, {"new_node", "new"}, {"serial", "", Show::json}, {"result"}};
    for (std::size_t i = 0; i < rows_.size(); ++i)
      table.rows.push_back(
          {rows_[i].node, rows_[i].to, ends_[i].serial ? Value(*ends_[i].serial) : Value(), ends_[i].result});
    return Value(std::move(table));
  }

  show::Desk* desk_;
  session::Session* session_;
  std::string text_;
  fs::path file_;
  fs::path path_;
  const AddressPlanOptions* options_;
  std::vector<AddressRow> rows_;
  std::vector<AddressChange> changes_;
  std::vector<RowEnd> ends_;
  AddressJournal journal_;
};

}  // namespace

Result<report::Value> run_address_plan(show::Desk& desk, std::string_view text, const fs::path& file,
                                       const AddressPlanOptions& options) {
  return PlanRun(desk, text, file, options).run();
}

}  // namespace servoctl::settings
