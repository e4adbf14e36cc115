#include "cabinet/apply.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/file.hpp"
#include "base/format.hpp"
#include "cabinet/axis_identity.hpp"
#include "cabinet/axis_run.hpp"
#include "cabinet/displaced.hpp"
#include "session/option_scope.hpp"
#include "session/state_pause.hpp"
#include "session/storage.hpp"
#include "settings/restore_journal.hpp"
#include "settings/restoring.hpp"
#include "show/audience.hpp"

namespace servoctl::cabinet {
namespace {

namespace fs = std::filesystem;
using report::Record;
using report::Value;
using settings::RestoreEnd;

/// It was asked for all axes at once.
class AskedBefore final : public show::Audience {
 public:
  Result<void> confirm(std::string_view /*question*/) override { return {}; }
};

class Applying {
 public:
  Applying(show::Desk& desk, const Cabinet& cabinet, std::span<const Station> stations,
           const ApplyOptions& options)
      : desk_(&desk), cabinet_(&cabinet), stations_(stations), options_(&options), choice_(options.choice) {
    choice_.keep = options.keep;
    looks_ = look_at_all(desk, cabinet, stations, choice_, options.resume);
    for (const auto& look : looks_)
      for (const auto& station : stations)
        if (station.axis == look.axis) runs_.emplace_back(station, &look);
  }

  Result<Value> run() {
    if (options_->resume && looks_.empty())
      return fail(Errc::usage, "there is nothing to resume: no apply of these axes was interrupted",
                  "leave --resume out");
    if (const auto placed = place(); !placed) return fail(placed.error());
    if (const auto may = may_begin(); !may) return fail(may.error());
    const bool any = std::any_of(runs_.begin(), runs_.end(), [&](const auto& run) { return has_work(run); });
    if (any && !desk_->dry_run)
      if (const auto agreed = ask(); !agreed) return fail(agreed.error());
    carry_out();
    if (options_->all_or_nothing && any_failed()) undo();
    tell();
    return answer();
  }

 private:
  /// Before anything else drives get the nodes that the file says.
  Result<void> place() {
    if (options_->resume || !choice_.only.empty()) return {};
    if (desk_->dry_run || options_->all_or_nothing) {
      (void)find_displaced(*desk_, stations_, choice_, looks_);
      return {};
    }
    return place_displaced(*desk_, *cabinet_, stations_, choice_, options_->unlock, looks_);
  }

  bool has_work(const AxisRun& run) const {
    return run.look->plan && (run.look->plan->to_write > 0 || options_->resume);
  }

  Result<void> may_begin() {
    for (auto& run : runs_)
      if (run.look->plan && !has_work(run)) run.end_without_write();
    if (!options_->all_or_nothing) return {};
    for (const auto& run : runs_) {
      auto why = run.look->plan ? hindrance(run) : std::optional(run.look->plan.error());
      if (!why && run.look->plan && !run.look->plan->left.empty()) why = run.look->plan->left.front();
      if (!why) continue;
      auto error = of_axis(*run.look->axis, std::move(*why));
      error.hint =
          message("--all-or-nothing: nothing was written{}{}", error.hint.empty() ? "" : "; ", error.hint);
      return fail(std::move(error));
    }
    return {};
  }

  /// What is known before the first write to keep it from being taken.
  std::optional<Error> hindrance(const AxisRun& run) const {
    if (!has_work(run) || desk_->dry_run) return std::nullopt;
    const auto node = run.look->axis->node;
    for (const auto& need : run.look->plan->needs) {
      if (need.kind == AxisNeed::Kind::power)
        return drive_error(Errc::refused, node, "it is energised: its settings cannot be changed now",
                           "`disable` de-energises it; make sure that the load is held");
      if (need.kind == AxisNeed::Kind::password && !options_->unlock && has_password(*run.station.profile))
        return drive_error(Errc::refused, node, message("its password locks {}", NameList{need.names}),
                           "add --unlock, which gives it and takes it back after");
    }
    return std::nullopt;
  }

  Result<void> ask() const {
    desk_->tell_value(Value(plan_record(*cabinet_, looks_)));
    std::size_t values = 0;
    std::size_t axes = 0;
    for (const auto& run : runs_) {
      if (!has_work(run)) continue;
      values += run.look->plan->to_write;
      ++axes;
    }
    return desk_->confirm(formatted("Write {} value{} to {} ax{}?", values, values == 1 ? "" : "s", axes,
                                    axes == 1 ? "is" : "es"));
  }

  /// Those that have something to do, with the numbers of their runs.
  std::vector<Station> stations(const std::function<bool(const AxisRun&)>& which,
                                std::vector<std::size_t>& numbers) const {
    std::vector<Station> out;
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      if (!which(runs_[i])) continue;
      out.push_back(runs_[i].station);
      numbers.push_back(i);
    }
    return out;
  }

  void carry_out() {
    std::vector<std::size_t> numbers;
    const auto at = stations([this](const AxisRun& run) { return has_work(run); }, numbers);
    at_all(at, [&](std::size_t i) { apply(runs_[numbers[i]]); });
  }

  void apply(AxisRun& run) {
    auto desk = desk_at(*desk_, run.station);
    AskedBefore asked;
    desk.audience = &asked;
    if (const auto why = hindrance(run)) {
      desk.errors.push_back(*why);
    } else if (const auto done = write(desk, run); !done) {
      desk.errors.push_back(done.error());
    }
    run.errors.insert(run.errors.end(), desk.errors.begin(), desk.errors.end());
    run.notices.insert(run.notices.end(), desk.notices.begin(), desk.notices.end());
  }

  Result<void> write(show::Desk& desk, AxisRun& run) const {
    const auto& axis = *run.look->axis;
    if (const auto single = wait_for_second(desk, axis); !single) return single;
    if (!desk.dry_run && !options_->resume)
      if (const auto noted = write_file_atomically(wanted_file(*cabinet_, axis, run.look->plan->before),
                                                   settings::backup_text(desk, run.look->plan->wanted));
          !noted)
        return noted;
    session::StatePause pause(*desk.session, axis.node);
    if (!desk.dry_run && needs_pause(*run.look->plan))
      if (const auto entered = pause.enter(); !entered) return entered;
    const auto done = settings::put_into(desk, run.look->plan->wanted, as_it_is(cabinet_->file.string()),
                                         axis.node, before_file(*cabinet_, axis), restoring(run));
    if (done) {
      run.end = end_of(done->end);
      run.in_flash = done->in_flash;
      if (desk.dry_run) run.frames = done->answer;
    }
    const auto left = pause.leave(run.end != AxisEnd::failed);
    desk.notices.insert(desk.notices.end(), pause.notices().begin(), pause.notices().end());
    forget_wanted(run);
    return done ? left : Result<void>(fail(done.error()));
  }

  static bool needs_pause(const AxisPlan& plan) {
    return std::any_of(plan.needs.begin(), plan.needs.end(),
                       [](const AxisNeed& need) { return need.kind == AxisNeed::Kind::state; });
  }

  settings::RestoringOptions restoring(const AxisRun& run) const {
    settings::RestoringOptions out{.choice = {.with_address = true}};
    out.keep = options_->keep && session::can_store(*run.station.profile);
    out.unlock = options_->unlock && has_password(*run.station.profile);
    out.resume = options_->resume;
    out.expected = run.look->plan->present;
    return out;
  }

  /// What was to be written is needed as long as there is something to resume.
  void forget_wanted(const AxisRun& run) const {
    std::error_code ignored;
    if (const auto& before = run.look->plan->before; !fs::exists(settings::journal_of(before), ignored))
      fs::remove(wanted_file(*cabinet_, *run.look->axis, before), ignored);
  }

  bool any_failed() const {
    return std::any_of(runs_.begin(), runs_.end(), [](const AxisRun& run) { return run.has_failed(); });
  }

  /// Puts back what was written already, as it was written.
  void undo() {
    if (desk_->dry_run) return;
    std::vector<std::size_t> numbers;
    const auto at = stations([](const AxisRun& run) { return run.is_written(); }, numbers);
    at_all(at, [&](std::size_t i) { put_back(runs_[numbers[i]]); });
  }

  void put_back(AxisRun& run) const {
    const auto& axis = *run.look->axis;
    const auto& file = run.look->plan->before;
    auto desk = desk_at(*desk_, run.station);
    AskedBefore asked;
    desk.audience = &asked;
    // What was begun is put in order, whoever is impatient.
    const session::Deaf deaf(*desk.session);
    auto how = restoring(run);
    how.resume = false;
    // What a drive worked with in its RAM are trials: none of them goes to the flash.
    how.keep = how.keep && run.in_flash.empty();
    how.expected.reset();
    const auto done = put_back_from(desk, axis, file, needs_pause(*run.look->plan), how);
    run.end_undo(done);
    run.errors.insert(run.errors.end(), desk.errors.begin(), desk.errors.end());
    run.notices.insert(run.notices.end(), desk.notices.begin(), desk.notices.end());
  }

  static Result<settings::Restored> put_back_from(show::Desk& desk, const Axis& axis, const fs::path& file,
                                                  bool pauses, const settings::RestoringOptions& how) {
    const auto backup = settings::read_backup(file);
    if (!backup) return fail(backup.error());
    session::StatePause pause(*desk.session, axis.node);
    if (pauses)
      if (const auto entered = pause.enter(); !entered) return fail(entered.error());
    auto done = settings::put_into(desk, *backup, as_it_is(file.string()), axis.node,
                                   formatted("{}.before-{}.json", file.string(), axis.name), how,
                                   settings::journal_of(file));
    if (const auto left = pause.leave(true); !left) desk.errors.push_back(left.error());
    desk.notices.insert(desk.notices.end(), pause.notices().begin(), pause.notices().end());
    return done;
  }

  void tell() {
    tell_looks(*desk_, looks_);
    for (auto& run : runs_) {
      for (const auto& error : run.errors) desk_->errors.push_back(of_axis(*run.look->axis, error));
      for (const auto& notice : run.notices) desk_->notices.push_back(of_axis(*run.look->axis, notice));
    }
    for (const auto& run : runs_)
      if (run.end == AxisEnd::applied && options_->keep) tell_unstated(run);
    const bool working = !options_->keep && std::any_of(runs_.begin(), runs_.end(), [](const AxisRun& run) {
      return run.end == AxisEnd::applied;
    });
    if (working)
      desk_->notices.emplace_back(
          "--no-keep: the values are gone after power-off; the next `cabinet plan` finds them as the file says, "
          "and `store` keeps them");
  }

  void tell_unstated(const AxisRun& run) {
    constexpr std::size_t kMostNamed = 4;
    auto names = unstated(run);
    if (names.empty()) return;
    const auto all = names.size();
    names.resize(std::min(all, kMostNamed));
    desk_->notices.push_back(
        message("axis {}: whether a {} keeps {}{} is not stated: `cabinet plan` after a power cycle tells",
                as_it_is(run.look->axis->name), as_it_is(run.look->axis->family), NameList{names},
                all > kMostNamed ? message(" and {} more", all - kMostNamed) : std::string()));
  }

  Value answer() const { return desk_->dry_run ? frames() : apply_table(runs_, options_->keep); }

  Value frames() const {
    Record out;
    for (const auto& run : runs_) {
      const auto& axis = *run.look->axis;
      const auto title = formatted("{}, node {}, {}", axis.name, axis.node, axis.family);
      out.push_back({axis.name, run.frames.is_null() ? Value(text_of(run.end)) : run.frames,
                     report::Show::everywhere, title});
    }
    return Value(std::move(out));
  }

  show::Desk* desk_;
  const Cabinet* cabinet_;
  std::span<const Station> stations_;
  const ApplyOptions* options_;
  PlanChoice choice_;
  std::vector<PlannedAxis> looks_;
  std::vector<AxisRun> runs_;
};

}  // namespace

Result<Value> apply_cabinet(show::Desk& desk, const Cabinet& cabinet, std::span<const Station> stations,
                            const ApplyOptions& options) {
  return Applying(desk, cabinet, stations, options).run();
}

}  // namespace servoctl::cabinet
