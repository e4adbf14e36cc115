#include "settings/restoring.hpp"

#include "base/format.hpp"
#include "drive/drive_settings.hpp"
#include "drive/standard_objects.hpp"
#include "session/identify.hpp"
#include "settings/before_file.hpp"
#include "settings/change.hpp"
#include "settings/comparison.hpp"
#include "settings/energising.hpp"
#include "settings/interrupted_restore.hpp"
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
  Restoring(show::Desk& desk, const Backup& backup, const Message& title, std::uint8_t node,
            const fs::path& before, const RestoringOptions& options, const fs::path& undoes)
      : desk_(&desk),
        backup_(&backup),
        title_(title),
        node_(node),
        before_(before),
        options_(options),
        attempt_{.backup = &backup, .title = title, .drive = {}, .undoes = undoes} {}

  Result<Restored> run() {
    const auto errors = desk_->errors.size();
    auto answer = carry_through();
    if (!answer) return fail(answer.error());
    const bool failed = desk_->errors.size() > errors;
    desk_->errors.insert(desk_->errors.end(), left_over_.begin(), left_over_.end());
    return Restored{std::move(*answer), failed, end_, std::move(in_flash_), file_->path()};
  }

 private:
  /// Two restores would take each other's notes for their own.
  Result<void> find_files() {
    auto drive = session::read_identity(*desk_->session, node_);
    if (!drive) return fail(drive.error());
    attempt_.drive = std::move(*drive);
    auto before = BeforeFile::take(*desk_, before_, title_, attempt_.drive);
    if (!before) return fail(before.error());
    file_.emplace(std::move(*before));
    if (desk_->dry_run || attempt_.undoes.empty()) return {};
    auto taken = FileLock::take(attempt_.undoes.string() + ".lock");
    if (!taken) return fail(taken.error());
    if (!*taken)
      return fail(Errc::refused,
                  message("another servoctl is restoring {} into node {}", title_, node_name(node_)),
                  "wait until it ends, or find it with `ps`");
    undone_lock_.emplace(std::move(**taken));
    return {};
  }

  Result<Value> carry_through() {
    if (const auto possible = check_keep(); !possible) return fail(possible.error());
    if (const auto found = find_files(); !found) return fail(found.error());
    auto left = take_up_interrupted(*desk_, *file_, attempt_, options_);
    if (!left) return fail(left.error());
    left_ = std::move(*left);
    auto choice = options_.choice;
    choice.keep = options_.keep;
    if (const auto old = old_values(); old)
      choice.before = *old;
    else
      return fail(old.error());
    RestoreTarget target(*desk_, *backup_, title_, node_, choice);
    if (const auto fits = target.prepare(); !fits) return fail(fits.error());
    if (const auto same = hold_to_expected(target.present()); !same) return fail(same.error());
    auto comparison = compare(desk_->profile, {formatted("node {}", node_), node_, target.present_and_left()},
                              {title_.text(), node_, target.wanted_and_left()}, true, desk_->chinese);
    left_over_ = target.left();
    left_count_ = target.left_count();
    const auto to_write = target.to_write();
    if (options_.keep)
      doubts_ = doubts_of_keeping(*desk_->profile, node_, title_, target.present(), target.asked());
    for (const auto& doubt : doubts_) desk_->notices.push_back(doubt);
    const bool idle = to_write == 0 && !options_.keep && left_.means.empty();
    keeps_address_ = target.keeps_address();
    if (idle) return take_away_journals(result(std::move(comparison.record), said(same()), {}));
    if (desk_->dry_run) {
      end_ = RestoreEnd::planned;
      return planned(target);
    }
    auto agreed =
        desk_->confirm(question(to_write) + power_question(*desk_, node_, target.present(), target.wanted()));
    if (agreed) agreed = target.check_standstill();
    if (!agreed) return fail(agreed.error());
    differs_ = to_write > 0 || options_.resume;
    if (const auto noted = note(target); !noted) return fail(noted.error());
    if (const auto back = put_means_back(*desk_->session, left_); !back) return fail(back.error());
    return carry_out(target, std::move(comparison.record));
  }

  /// What the drive held when the restore began that this one continues; nothing where it is a new one.
  Result<session::Values> old_values() const {
    session::Values out;
    if (!options_.resume) return out;
    const auto old = read_backup(file_->path());
    if (!old) return fail(old.error());
    for (const auto& entry : old->entries)
      if (entry.bytes) out.emplace(entry.object, *entry.bytes);
    return out;
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
                      message("{} has changed since the plan was made: it held {} then, and holds {} now",
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

  std::string question(std::size_t different) const {
    const auto* const rest =
        options_.keep ? "Store them in the drive" : "Restore its memory switch and password";
    if (different == 0)
      return left_count_ == 0
                 ? formatted("All values of node {} already match {}. {}?", node_, title_.text(), rest)
                 : formatted("All other values of node {} already match {}. {}?", node_, title_.text(), rest);
    if (different == 1) return formatted("Write 1 value of {} to node {}?", title_.text(), node_);
    return formatted("Write {} values of {} to node {}?", different, title_.text(), node_);
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

  /// What the drive holds now, beside the backup. A restore that is gone on with has noted it already.
  Result<void> note(const RestoreTarget& target) {
    if (options_.resume) return {};
    session::Snapshot snapshot;
    snapshot.identity = attempt_.drive;
    snapshot.identity.hardware_version = target.identity().hardware_version;
    snapshot.identity.software_version = target.identity().software_version;
    for (const auto& [object, data] : target.present()) snapshot.entries.push_back({object, data, {}});
    RestoreJournal journal;
    journal.checksum = checksum(*backup_);
    journal.node = node_;
    journal.with_address = options_.choice.with_address;
    journal.force = options_.choice.force;
    journal.keep = options_.keep;
    journal.unlock = options_.unlock;
    journal.means = left_.means;
    // Of a drive that holds the values already nothing is old: those from before an earlier restore stay.
    std::error_code ignored;
    if (!differs_ && fs::exists(file_->path(), ignored))
      return note_journal(*desk_, file_->path(), std::move(journal));
    tell_other_name();
    return note_before(*desk_, file_->path(), snapshot, std::move(journal));
  }

  void tell_other_name() const {
    for (const auto& other : file_->passed_over())
      if (other.path == before_)
        desk_->notices.push_back(message("{} is left as it is, {}: the old values of node {} go to {}",
                                         as_it_is(before_.string()), other.origin.why, node_name(node_),
                                         as_it_is(file_->path().string())));
  }

  Value take_away_journals(Value done) {
    std::error_code ignored;
    fs::remove(file_->journal(), ignored);
    if (!left_.checksum.empty() && !attempt_.undoes.empty()) fs::remove(attempt_.undoes, ignored);
    return done;
  }

  Result<Value> carry_out(const RestoreTarget& target, Record record) {
    const auto outcome =
        session::restore(*desk_->session, desk_->profile, node_, target.present(), target.wanted(),
                         {.roll_back = options_.roll_back, .keep = options_.keep, .unlock = options_.unlock});
    end_ = end_of(outcome);
    in_flash_ = outcome.in_flash;
    const bool may_hold = !outcome.failure || outcome.writes > 0 || !outcome.astray.empty();
    if (end_ != RestoreEnd::rolled_back && may_hold)
      tell_power_values(*desk_, node_, target.present(), target.wanted());
    for (const auto& notice : outcome.notices) desk_->notices.push_back(notice);
    if (differs_)
      desk_->notices.push_back(
          message("the old values of node {} are in {}", node_name(node_), as_it_is(file_->path().string())));
    const auto* const stored = leaves_some() ? "nothing else differs; stored" : "nothing differs; stored";
    const auto* const done = differs_ || !options_.keep ? "restored" : stored;
    if (!outcome.failure) return take_away_journals(result(std::move(record), said(done), outcome));
    for (auto& error : errors_of(outcome, desk_->profile, node_)) desk_->errors.push_back(std::move(error));
    auto out = result(std::move(record), failed_state(outcome), outcome);
    // Undone to the end: nothing is left to go on with. What is being taken back itself stays begun.
    if (end_ == RestoreEnd::rolled_back && left_.checksum.empty()) return take_away_journals(std::move(out));
    // `store` is what is left to do.
    if (outcome.all_written && is_refused_store(*outcome.failure)) return take_away_journals(std::move(out));
    desk_->notices.push_back(
        message("node {}: --resume continues once the cause is removed", node_name(node_)));
    return out;
  }

  bool leaves_some() const { return keeps_address_ || left_count_ > 0; }
  const char* same() const { return leaves_some() ? "nothing else differs" : "nothing differs"; }
  std::string said(std::string state) const {
    return left_count_ == 0 ? state : formatted("{}; {} left as it is", state, left_count_);
  }

  /// Of all values; null where it is not known of one.
  Value kept_value(const std::optional<session::RestoreOutcome>& outcome) const {
    if (!outcome || outcome->kept == session::Kept::unknown) return {};
    return outcome->kept == session::Kept::yes && !doubts_.empty() ? Value()
                                                                   : outcome->kept == session::Kept::yes;
  }

  Value result(Record record, std::string_view state,
               const std::optional<session::RestoreOutcome>& outcome) const {
    Record out{{"node", node_}, {"result", state}, {"kept", kept_value(outcome)}};
    for (auto& field : record) out.push_back(std::move(field));
    return out;
  }

  show::Desk* desk_;
  const Backup* backup_;
  Message title_;
  std::uint8_t node_;
  fs::path before_;  ///< The usual name for the old values.
  RestoringOptions options_;
  RestoreAttempt attempt_;
  std::optional<BeforeFile> file_;
  std::optional<FileLock> undone_lock_;
  std::vector<Error> left_over_;  ///< As RestoreTarget::left().
  std::size_t left_count_ = 0;    ///< Values that differ and are not written.
  std::vector<Message> doubts_;   ///< Of keeping.
  RestoreJournal left_;           ///< Of what was cut off and is gone on with, or undone.
  bool differs_ = true;           ///< The drive does not hold the values yet.
  bool keeps_address_ = false;    ///< The backup's would be another.
  RestoreEnd end_ = RestoreEnd::idle;
  std::vector<ObjectAddress> in_flash_;
};

}  // namespace

Result<Restored> put_into(show::Desk& desk, const Backup& backup, const Message& title, std::uint8_t node,
                          const fs::path& before, const RestoringOptions& options, const fs::path& undoes) {
  return Restoring(desk, backup, title, node, before, options, undoes).run();
}

}  // namespace servoctl::settings
