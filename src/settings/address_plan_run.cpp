#include "settings/address_plan_run.hpp"

#include <algorithm>

#include "base/checksum.hpp"
#include "base/file_lock.hpp"
#include "base/format.hpp"
#include "canopen/node_list.hpp"
#include "drive/bitrate.hpp"
#include "settings/address_plan_bitrate.hpp"
#include "settings/address_plan_frames.hpp"
#include "settings/address_resume.hpp"
#include "settings/address_table.hpp"
#include "show/identity.hpp"

namespace servoctl::settings {
namespace {

using report::Show;
using report::Table;
using report::Value;

/// What came of one drive.
struct RowEnd {
  std::string result = "not reached";
  std::optional<std::uint32_t> serial;
};

class PlanRun {
 public:
  PlanRun(show::Desk& desk, std::string_view text, const std::filesystem::path& file,
          const AddressPlanOptions& options)
      : desk_(&desk),
        session_(desk.session),
        text_(text),
        file_(file),
        path_(address_journal_of(file)),
        options_(&options),
        bitrate_(desk, options) {}

  Result<Value> run() {
    auto rows = parse_address_plan(text_, file_.string());
    if (!rows) return fail(rows.error());
    rows_ = std::move(*rows);
    ends_.resize(rows_.size());
    auto lock = desk_->dry_run ? Result<std::optional<FileLock>>(std::nullopt)
                               : FileLock::take(path_.string() + ".lock");
    if (!lock) return fail(lock.error());
    if (!desk_->dry_run && !*lock)
      return fail(Errc::refused, message("another servoctl is carrying out {}", as_it_is(file_.string())),
                  "wait until it ends, or find it with `ps`");
    if (const auto named = name_families(); !named) return fail(named.error());
    if (const auto known = take_up(); !known) return fail(known.error());
    if (const auto looked = look(); !looked) return fail(looked.error());
    if (const auto looked = look_at_bitrates(); !looked) return fail(looked.error());
    if (desk_->dry_run) return frames();
    if (nothing_to_do()) return answer();
    if (const auto agreed = ask(); !agreed) return fail(agreed.error());
    if (const auto done = carry_out(); !done) return fail(done.error());
    return answer();
  }

 private:
  Result<void> name_families() {
    for (const auto& row : rows_) {
      const auto profile =
          options_->family_of ? options_->family_of(row) : Result<const drive::Profile*>(desk_->profile);
      if (!profile) return fail(with_row(row, profile.error()));
      profiles_.push_back(*profile);
    }
    return {};
  }

  Result<AddressChange> plan_row(std::size_t row, std::uint8_t node, const AddressWish& wish) {
    const FamilyScope family(*desk_, profiles_[row]);
    return plan_address(*desk_, node, wish);
  }

  /// Only where the drive is the one that was there when the plan was made.
  Result<AddressChange> plan_again(std::size_t row, std::uint8_t node, AddressWish wish) {
    wish.serial = rows_[row].serial;
    auto change = plan_row(row, node, wish);
    if (!change || show::change_of(journal_.drives[row], change->identity).empty()) return change;
    return fail(drive_error(Errc::refused, node, "another drive is there than when the plan was made",
                            "`scan --long` shows who is there"));
  }

  /// Whether what stands at its place now is a drive of its family.
  Result<void> hold(std::size_t row, std::uint8_t node) const {
    const auto held = options_->hold ? options_->hold(node, *profiles_[row]) : Result<void>();
    return held ? Result<void>() : fail(with_row(rows_[row], held.error()));
  }

  Result<void> take_up() {
    auto journal = begin_address_journal(file_, checksum_of(text_), rows_.size(), options_->resume);
    if (!journal) return fail(journal.error());
    journal_ = std::move(*journal);
    return options_->resume ? same_families(rows_, profiles_, journal_) : Result<void>();
  }

  Result<void> look() {
    if (options_->resume) return look_again();
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (const auto held = hold(i, rows_[i].node); !held) return held;
    const auto used = session::nodes_in_use(*session_, canopen::every_node_id(), {.guards = !desk_->dry_run});
    if (!used) return fail(used.error());
    tell_unguarded(*desk_);
    std::set<std::uint8_t> taken;
    for (const auto& each : *used) taken.insert(each.first);
    auto steps = order_address_steps(rows_, taken);
    if (!steps) return fail(steps.error());
    journal_.steps = std::move(*steps);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (const auto looked = look_at(i); !looked) return looked;
    return {};
  }

  Result<void> look_again() {
    if (const auto settled = settle_address_step(*session_, journal_); !settled) return settled;
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (rows_[i].bitrate || has_steps_left(journal_, i))
        if (const auto held = hold(i, place_of_row(rows_[i], journal_, i)); !held) return held;
    return {};
  }

  Result<void> look_at(std::size_t i) {
    const auto& row = rows_[i];
    auto change =
        plan_row(i, row.node, {.node = row.to, .bus_bitrate = options_->bus_bitrate, .serial = row.serial});
    if (!change) return fail(with_row(row, change.error()));
    if (row.bitrate)
      if (const auto fits = plan_row(i, row.node, {.bitrate = row.bitrate}); !fits)
        return fail(with_row(row, fits.error()));
    journal_.drives.push_back(change->identity);
    journal_.families.push_back(profiles_[i]->family);
    changes_.push_back(std::move(*change));
    return {};
  }

  bool nothing_to_do() {
    if (options_->resume || !journal_.steps.empty() || bitrate_of(rows_)) return false;
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (!changes_[i].idle()) return false;
    for (std::size_t i = 0; i < rows_.size(); ++i) note(i, text_of(AddressEnd::nothing_to_do));
    return true;
  }

  Result<Value> frames() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const auto goes_aside = std::count_if(journal_.steps.begin(), journal_.steps.end(),
                                            [&](const AddressStep& step) { return step.row == i; }) > 1;
      if (rows_[i].bitrate && !journal_.steps.empty())
        desk_->notices.push_back(
            message("node {}: its bitrate is written at the end, when all have moved", rows_[i].to));
      if (goes_aside)
        desk_->notices.push_back(message("node {}: it steps aside to a free node-ID first, see the steps",
                                         node_name(rows_[i].node)));
    }
    show_steps();
    bitrate_.tell_commands();
    return planned_address_plan(*desk_, rows_, profiles_, journal_, options_->each.unlock);
  }

  void show_steps() const {
    if (journal_.done < journal_.steps.size()) desk_->tell_value(Value(address_steps(rows_, journal_)));
  }

  Result<void> look_at_bitrates() {
    const auto bitrate = bitrate_of(rows_);
    if (!bitrate) return {};
    const auto changes = planned_bitrates(*desk_, rows_, profiles_, journal_);
    return changes ? bitrate_.look(*changes, *bitrate) : fail(changes.error());
  }

  Result<void> ask() const {
    show_steps();
    return desk_->confirm(
        question_address_plan(rows_, journal_.steps.size() - journal_.done, bitrate_.then()));
  }

  Result<void> carry_out() {
    if (const auto noted = write_address_journal(path_, journal_); !noted) return noted;
    const bool all =
        move_all() && set_bitrates() &&
        bitrate_.end(rows_, [this](std::size_t row, std::string_view result) { note(row, result); });
    if (options_->moved)
      for (std::size_t i = 0; i < rows_.size(); ++i)
        if (rows_[i].node != rows_[i].to && place_of_row(rows_[i], journal_, i) == rows_[i].to)
          options_->moved(rows_[i], ends_[i].serial);
    std::error_code ignored;
    if (all || (!options_->resume && journal_.done == 0 && !journal_.begun && !has_written_bitrate_))
      std::filesystem::remove(path_, ignored);
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
    const std::uint8_t to[] = {step.to};
    const auto change =
        plan_again(step.row, step.from, {.node = step.to, .bus_bitrate = options_->bus_bitrate});
    if (!change) return stop(step.row, change.error());
    if (const auto free = refuse_taken(*desk_, to, Duration::zero()); !free)
      return stop(step.row, free.error());
    journal_.begun = true;
    if (const auto noted = write_address_journal(path_, journal_); !noted)
      return stop(step.row, noted.error());
    const auto outcome = change_address(*desk_, *change, options_->each);
    note(step.row, text_of(outcome.end));
    if (outcome.end == AddressEnd::as_before) journal_.begun = false;
    if (outcome.end != AddressEnd::moved) return stop(step.row, outcome.error.value_or(awaits_power(step)));
    if (outcome.error) desk_->errors.push_back(with_row(rows_[step.row], *outcome.error));
    journal_.begun = false;
    ++journal_.done;
    if (const auto noted = write_address_journal(path_, journal_); !noted)
      return stop(step.row, noted.error());
    return true;
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
        note_idle(i);
        continue;
      }
      auto change = plan_again(i, rows_[i].to, {.bitrate = rows_[i].bitrate});
      if (!change) return stop(i, change.error());
      auto outcome = change_address(*desk_, *change, options_->each);
      has_written_bitrate_ = has_written_bitrate_ || (outcome.end != AddressEnd::nothing_to_do &&
                                                      outcome.end != AddressEnd::as_before);
      if (outcome.error) return stop(i, *outcome.error);
      if (outcome.end == AddressEnd::nothing_to_do)
        note_idle(i);
      else
        note(i, formatted("{} from the next start", drive::bitrate_text(*rows_[i].bitrate)));
      bitrate_.add(i, std::move(*change), std::move(outcome));
    }
    return true;
  }

  void note(std::size_t row, std::string_view result) {
    ends_[row].result = result;
    ends_[row].serial = journal_.drives[row].serial;
  }

  void note_idle(std::size_t row) {
    if (ends_[row].result == "not reached") note(row, text_of(AddressEnd::nothing_to_do));
  }

  Value answer() const {
    Table table;
    table.columns = {{"node"}, {"new_node", "new"}, {"family"}, {"serial", "", Show::json}, {"result"}};
    for (std::size_t i = 0; i < rows_.size(); ++i)
      table.rows.push_back({rows_[i].node, rows_[i].to, profiles_[i]->family,
                            ends_[i].serial ? Value(*ends_[i].serial) : Value(), ends_[i].result});
    return Value(std::move(table));
  }

  show::Desk* desk_;
  session::Session* session_;
  std::string text_;
  std::filesystem::path file_;
  std::filesystem::path path_;
  const AddressPlanOptions* options_;
  std::vector<AddressRow> rows_;
  std::vector<const drive::Profile*> profiles_;  ///< Of each row.
  std::vector<AddressChange> changes_;
  std::vector<RowEnd> ends_;
  AddressJournal journal_;
  bool has_written_bitrate_ = false;
  PlanBitrate bitrate_;
};

}  // namespace

Result<report::Value> run_address_plan(show::Desk& desk, std::string_view text,
                                       const std::filesystem::path& file, const AddressPlanOptions& options) {
  return PlanRun(desk, text, file, options).run();
}

}  // namespace servoctl::settings
