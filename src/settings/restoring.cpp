#include "settings/restoring.hpp"

#include <fmt/format.h>

#include "base/file_lock.hpp"
#include "drive/drive_settings.hpp"
#include "drive/standard_objects.hpp"
#include "settings/change.hpp"
#include "settings/comparison.hpp"
#include "settings/restore_journal.hpp"
#include "settings/restore_keeping.hpp"
#include "show/planned_messages.hpp"

namespace servoctl::settings {
namespace {

namespace fs = std::filesystem;
using report::Record;
using report::Value;

/// One restore, from file to outcome.
class Restoring {
 public:
  Restoring(show::Desk& desk, const Backup& backup, const std::string& title, std::uint8_t node,
            const fs::path& before, const RestoringOptions& options, const fs::path& undoes)
      : desk_(&desk),
        backup_(&backup),
        title_(title),
        node_(node),
        before_(before),
        undoes_(undoes),
        options_(options) {}

  Result<Restored> run() {
    const auto locked = lock();
    if (!locked) return fail(locked.error());
    const auto errors = desk_->errors.size();
    auto answer = carry_through();
    if (!answer) return fail(answer.error());
    const bool failed = desk_->errors.size() > errors;
    desk_->errors.insert(desk_->errors.end(), left_over_.begin(), left_over_.end());
    return Restored{std::move(*answer), failed, end_};
  }

 private:
  /// Two restores of one file and node would take each other's notes for their own.
  Result<std::vector<FileLock>> lock() const {
    std::vector<FileLock> out;
    if (desk_->dry_run) return out;
    for (const auto& file : {journal(), undoes_}) {
      if (file.empty() || (!out.empty() && file == journal())) continue;
      auto taken = FileLock::take(file.string() + ".lock");
      if (!taken) return fail(taken.error());
      if (!*taken)
        return fail(Errc::refused,
                    fmt::format("another servoctl is restoring {} into node {}", title_, node_),
                    "wait until it ends, or find it with `ps`");
      out.push_back(std::move(**taken));
    }
    return out;
  }

  Result<Value> carry_through() {
    if (const auto possible = check_keep(); !possible) return fail(possible.error());
    if (const auto known = take_up_journals(); !known) return fail(known.error());
    auto choice = options_.choice;
    choice.keep = options_.keep;
    RestoreTarget target(*desk_, *backup_, title_, node_, choice);
    if (const auto fits = target.prepare(); !fits) return fail(fits.error());
    if (const auto same = hold_to_expected(target.present()); !same) return fail(same.error());
    auto comparison = compare(desk_->profile, {fmt::format("node {}", node_), node_, target.present()},
                              {title_, node_, target.wanted()}, true, desk_->chinese);
    left_over_ = target.left();
    if (options_.keep)
      doubts_ = doubts_of_keeping(*desk_->profile, node_, title_, target.present(), target.wanted());
    for (const auto& doubt : doubts_) desk_->notices.push_back(doubt);
    const bool idle = comparison.different == 0 && !options_.keep && left_.means.empty();
    if (idle) return take_away_journals(result(std::move(comparison.record), said("nothing differs"), {}));
    if (desk_->dry_run) {
      end_ = RestoreEnd::planned;
      return planned(target);
    }
    if (const auto answer = desk_->confirm(question(comparison.different)); !answer)
      return fail(answer.error());
    if (const auto noted = note(target); !noted) return fail(noted.error());
    if (const auto back = put_means_back(*desk_->session, left_); !back) return fail(back.error());
    return carry_out(target, std::move(comparison.record));
  }

  /// A family that cannot store is told so before anything is written.
  Result<void> check_keep() const {
    if (!options_.keep || session::can_store(*desk_->profile)) return {};
    return fail(drive_error(Errc::negative, node_, "this family cannot be told to keep values",
                            "nothing was written; without --keep they are, and a power cycle shows whether "
                            "they survive it"));
  }

  /// Only what was agreed to is done.
  Result<void> hold_to_expected(const session::Values& present) const {
    if (!options_.expected) return {};
    const auto refuse = [this](ObjectAddress object, std::string_view then, std::string_view now) {
      return fail(
          drive_error(Errc::refused, node_, object,
                      fmt::format("{} has changed since the plan was made: it held {} then, and holds {} now",
                                  name_of(drive::target_at(desk_->profile, object)), then, now),
                      "nothing was written to this drive; look at the plan again"));
    };
    for (const auto& [object, then] : *options_.expected)
      if (present.count(object) == 0) return refuse(object, to_hex(then), "nothing that can be read");
    for (const auto& [object, now] : present) {
      const auto then = options_.expected->find(object);
      if (then == options_.expected->end()) return refuse(object, "nothing that could be read", to_hex(now));
      if (then->second != now) return refuse(object, to_hex(then->second), to_hex(now));
    }
    return {};
  }

  fs::path journal() const { return journal_of(before_); }

  /// A restore that was cut off is gone on with or undone, never begun anew: what the drive held before is in
  /// its file, and must not be replaced by what it holds now.
  Result<void> take_up_journals() {
    const auto found = read_journal(*desk_, journal());
    if (!found) return fail(found.error());
    if (*found && !options_.resume)
      return fail(Errc::refused, fmt::format("a restore of {} to node {} was interrupted", title_, node_),
                  fmt::format("--resume continues it; `restore {} -n {}` restores the old values",
                              before_.string(), node_));
    if (!*found && options_.resume)
      return fail(Errc::usage,
                  fmt::format("there is nothing to resume: {} does not exist", journal().string()),
                  "leave --resume out");
    if (options_.resume) return resume(**found);
    if (undoes_.empty()) return {};
    const auto undone = read_journal(*desk_, undoes_);
    if (!undone) return fail(undone.error());
    if (!*undone || (*undone)->node != node_) return {};
    left_ = **undone;
    // What went to the flash has to go there again.
    options_.keep = options_.keep || keeps(left_);
    options_.unlock = options_.unlock || left_.unlock;
    return {};
  }

  Result<void> resume(const RestoreJournal& found) {
    if (found.checksum != checksum(*backup_) || found.node != node_)
      return fail(Errc::refused, fmt::format("{} is not the file being restored to node {}", title_, node_),
                  fmt::format("resuming needs the same values; `restore {} -n {}` restores the old ones",
                              before_.string(), node_));
    left_ = found;
    options_.choice = {.with_address = found.with_address,
                       .force = found.force,
                       .skip_invalid = options_.choice.skip_invalid};
    options_.keep = keeps(found);
    options_.unlock = found.unlock;
    return {};
  }

  /// To keep them is not asked again of a family that cannot: it would fail for ever.
  bool keeps(const RestoreJournal& journal) const {
    return journal.keep && session::can_store(*desk_->profile);
  }

  std::string question(std::size_t different) const {
    if (different == 0)
      return fmt::format(
          "All values of node {} already match {}. {}?", node_, title_,
          options_.keep ? "Store them in the drive" : "Restore its memory switch and password");
    return fmt::format("Write {} values of {} to node {}?", different, title_, node_);
  }

  Result<Value> planned(const RestoreTarget& target) const {
    session::Rehearsal rehearsal;
    for (const auto& [object, data] : left_.means)
      rehearsal.add(session::planned_write({node_, object, data}));
    const auto gone_through =
        session::rehearse_restore(*desk_->session, desk_->profile, node_, target.present(), target.wanted(),
                                  {.keep = options_.keep, .unlock = options_.unlock}, rehearsal);
    if (!gone_through) return fail(gone_through.error());
    return show::planned_messages(*desk_, rehearsal.messages());
  }

  /// What the drive holds now, beside the backup: the way back when everything else fails. One that is gone
  /// on with has noted it already.
  Result<void> note(const RestoreTarget& target) {
    if (options_.resume) return {};
    session::Snapshot snapshot;
    snapshot.identity = target.identity();
    for (const auto& [object, data] : target.present()) snapshot.entries.push_back({object, data, {}});
    RestoreJournal journal;
    journal.checksum = checksum(*backup_);
    journal.node = node_;
    journal.with_address = options_.choice.with_address;
    journal.force = options_.choice.force;
    journal.keep = options_.keep;
    journal.unlock = options_.unlock;
    journal.means = left_.means;
    return note_before(*desk_, before_, snapshot, std::move(journal));
  }

  Value take_away_journals(Value done) {
    std::error_code ignored;
    fs::remove(journal(), ignored);
    if (!left_.checksum.empty() && !undoes_.empty()) fs::remove(undoes_, ignored);
    return done;
  }

  Result<Value> carry_out(const RestoreTarget& target, Record record) {
    const auto outcome =
        session::restore(*desk_->session, desk_->profile, node_, target.present(), target.wanted(),
                         {.roll_back = options_.roll_back, .keep = options_.keep, .unlock = options_.unlock});
    end_ = end_of(outcome);
    for (const auto& notice : outcome.notices) desk_->notices.push_back(notice);
    desk_->notices.push_back(fmt::format("the old values of node {} are in {}", node_, before_.string()));
    if (!outcome.failure) return take_away_journals(result(std::move(record), said("restored"), outcome));
    desk_->errors.push_back(*outcome.failure);
    add_astray(outcome);
    auto out = result(std::move(record), failed_state(outcome), outcome);
    // Undone to the end: nothing is left to go on with. What is being taken back itself stays begun.
    if (outcome.rolled_back && left_.checksum.empty()) return take_away_journals(std::move(out));
    // To go on would be refused in the same way, and so would be to undo it: `store` is what is left to do.
    if (outcome.all_written && is_refused_store(*outcome.failure)) return take_away_journals(std::move(out));
    desk_->notices.push_back(fmt::format("node {}: --resume continues once the cause is removed", node_));
    return out;
  }

  static bool is_refused_store(const Error& error) {
    return error.abort_code && error.object && error.object->index == objects::kStoreIndex;
  }

  void add_astray(const session::RestoreOutcome& outcome) {
    for (const auto object : outcome.astray) {
      desk_->errors.push_back(
          drive_error(Errc::negative, node_, object,
                      "it may hold neither the value that was to be written nor its old one"));
    }
  }

  std::string said(std::string state) const {
    return left_over_.empty() ? state : fmt::format("{}; {} left as it is", state, left_over_.size());
  }

  static RestoreEnd end_of(const session::RestoreOutcome& outcome) {
    if (!outcome.failure) return RestoreEnd::done;
    if (outcome.rolled_back) return RestoreEnd::rolled_back;
    if (outcome.all_written) return RestoreEnd::not_kept;
    return outcome.astray.empty() ? RestoreEnd::left : RestoreEnd::astray;
  }

  static std::string_view failed_state(const session::RestoreOutcome& outcome) {
    if (outcome.rolled_back) return "failed; every value is as it was before";
    if (outcome.all_written) return "written and read back; see the error";
    return outcome.astray.empty() ? "failed; what was written stays written" : "failed; see the errors";
  }

  /// Of all values; null where it is not known of one.
  Value kept_value(const std::optional<session::RestoreOutcome>& outcome) const {
    if (!outcome || outcome->kept == session::Kept::unknown) return {};
    if (outcome->kept == session::Kept::yes && !doubts_.empty()) return {};
    return outcome->kept == session::Kept::yes;
  }

  Value result(Record record, std::string_view state,
               const std::optional<session::RestoreOutcome>& outcome) const {
    Record out{{"node", node_}, {"result", state}, {"kept", kept_value(outcome)}};
    for (auto& field : record) out.push_back(std::move(field));
    return out;
  }

  show::Desk* desk_;
  const Backup* backup_;
  std::string title_;
  std::uint8_t node_;
  fs::path before_;
  fs::path undoes_;
  RestoringOptions options_;
  std::vector<Error> left_over_;     ///< Values outside of the limits.
  std::vector<std::string> doubts_;  ///< Of keeping.
  RestoreJournal left_;              ///< Of what was cut off and is gone on with, or undone.
  RestoreEnd end_ = RestoreEnd::idle;
};

}  // namespace

Result<Restored> put_into(show::Desk& desk, const Backup& backup, const std::string& title, std::uint8_t node,
                          const fs::path& before, const RestoringOptions& options, const fs::path& undoes) {
  return Restoring(desk, backup, title, node, before, options, undoes).run();
}

}  // namespace servoctl::settings
