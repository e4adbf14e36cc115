#include "settings/interrupted_restore.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "session/storage.hpp"

namespace servoctl::settings {
namespace {

using std::filesystem::path;

class TakingUp {
 public:
  TakingUp(show::Desk& desk, const BeforeFile& before, const RestoreAttempt& attempt,
           RestoringOptions& options)
      : desk_(&desk), before_(&before), attempt_(&attempt), options_(&options), node_(attempt.drive.node) {}

  Result<RestoreJournal> run() {
    const auto found = read_journal(*desk_, before_->journal());
    if (!found) return fail(found.error());
    if (*found && !options_->resume)
      return fail(Errc::refused,
                  message("a restore of {} to node {} was interrupted", attempt_->title, node_name(node_)),
                  message("--resume continues it; `restore {} -n {}` restores the old values",
                          as_it_is(before_->path().string()), node_name(node_)));
    if (!*found && options_->resume) return fail(nothing_to_resume(*before_, attempt_->title, node_));
    if (options_->resume) return resume(**found);
    return undo();
  }

 private:
  Result<RestoreJournal> resume(const RestoreJournal& found) {
    if (found.checksum != checksum(*attempt_->backup) || found.node != node_)
      return fail(Errc::refused,
                  message("{} is not the file being restored to node {}", attempt_->title, node_name(node_)),
                  message("resuming needs the same values; `restore {} -n {}` restores the old ones",
                          as_it_is(before_->path().string()), node_name(node_)));
    options_->choice = {.with_address = found.with_address,
                        .force = found.force,
                        .skip_invalid = options_->choice.skip_invalid};
    options_->keep = keeps(found);
    options_->unlock = found.unlock;
    return found;
  }

  Result<RestoreJournal> undo() {
    if (attempt_->undoes.empty()) return RestoreJournal{};
    const auto undone = read_journal(*desk_, attempt_->undoes);
    if (!undone) return fail(undone.error());
    if (!*undone || (*undone)->node != node_) return RestoreJournal{};
    const auto origin = origin_of(*desk_, *attempt_->backup, attempt_->drive);
    if (const auto own = hold_to_own(origin); !own) return fail(own.error());
    if (origin.kind == Origin::Kind::other) return RestoreJournal{};
    // What went to the flash has to go there again, but for trials: those were in the RAM alone.
    const bool keeps_trials = keeps(**undone) && worked_in_ram(*desk_->profile, **undone);
    if (keeps_trials && !options_->keep)
      desk_->notices.push_back(message(
          "node {}: it worked in RAM when the restore that is undone began, so the old values go to its RAM; "
          "its flash may hold new ones: --keep writes the old ones there, too",
          node_name(node_)));
    options_->keep = options_->keep || (keeps(**undone) && !keeps_trials);
    options_->unlock = options_->unlock || (*undone)->unlock;
    return **undone;
  }

  /// With --force the values of another drive are a backup like any other, and its journal stays.
  Result<void> hold_to_own(const Origin& origin) const {
    if (origin.kind == Origin::Kind::same || options_->choice.force) return {};
    if (origin.kind == Origin::Kind::other)
      return fail(
          drive_error(Errc::refused, node_,
                      message("{} has the old values of another drive, whose restore was interrupted: {}",
                              attempt_->title, origin.why),
                      "--force restores them to this one; the interrupted restore stays as it is"));
    return fail(drive_error(
        Errc::refused, node_,
        message("{} has the old values of the drive on {}, and nothing tells whether this is that drive",
                attempt_->title, as_it_is(origin.bus)),
        "--force restores them, where it is"));
  }

  /// To keep them is not asked again of a family that cannot: it would fail for ever.
  bool keeps(const RestoreJournal& journal) const {
    return journal.keep && session::can_store(*desk_->profile);
  }

  show::Desk* desk_;
  const BeforeFile* before_;
  const RestoreAttempt* attempt_;
  RestoringOptions* options_;
  std::uint8_t node_;
};

}  // namespace

Result<RestoreJournal> take_up_interrupted(show::Desk& desk, const BeforeFile& before,
                                           const RestoreAttempt& attempt, RestoringOptions& options) {
  return TakingUp(desk, before, attempt, options).run();
}

Error nothing_to_resume(const BeforeFile& before, const Message& title, std::uint8_t node) {
  const auto& others = before.passed_over();
  const auto other =
      std::find_if(others.begin(), others.end(), [](const auto& one) { return one.has_journal; });
  if (other == others.end())
    return make_error(
        Errc::usage,
        message("there is nothing to resume: {} does not exist", as_it_is(before.journal().string())),
        "leave --resume out");
  return drive_error(
      Errc::refused, node,
      message("the restore of {} that was interrupted was of another drive: {}", title, other->origin.why),
      message("leave --resume out to begin anew with this one; the old values of the other stay in {}",
              as_it_is(other->path.string())));
}

}  // namespace servoctl::settings
