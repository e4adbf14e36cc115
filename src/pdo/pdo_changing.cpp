#include "pdo/pdo_changing.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/standard_objects.hpp"
#include "pdo/other_pdo.hpp"
#include "pdo/pdo_neighbours.hpp"
#include "pdo/pdo_record.hpp"
#include "session/pdo_change.hpp"
#include "session/pdo_setup.hpp"
#include "session/storage.hpp"
#include "settings/change.hpp"
#include "settings/keeping_nodes.hpp"
#include "show/pdo_check.hpp"
#include "show/pdo_report.hpp"
#include "show/planned_messages.hpp"

namespace servoctl::pdo {
namespace {

using canopen::Pdo;
using report::List;
using report::Record;
using report::Show;
using report::Value;
using session::Values;

/// What is to be done to one node.
struct Job {
  PresentPdos present;
  WantedPdos wanted;
  Values values;  ///< All that is to be written, stored copies included.
  std::vector<session::PlannedWrite> plan;
};

/// A change that was cut off and is put back.
struct Undone {
  PdoRecord record;
  settings::RestoreJournal journal;
};

/// One command's change of some nodes.
class Changing {
 public:
  Changing(show::Desk& desk, const PdoEdit& edit, const PdoChanging& how)
      : desk_(&desk), edit_(&edit), how_(how) {}

  Result<Value> run() {
    if (const auto known = take_up_record(); !known) return fail(known.error());
    if (const auto planned = plan_all(); !planned) return fail(planned.error());
    const bool any =
        undone_ || std::any_of(jobs_.begin(), jobs_.end(), [](const Job& job) { return !job.plan.empty(); });
    if (any)
      if (const auto quiet = check_quiet(); !quiet) return fail(quiet.error());
    if (desk_->dry_run) return frames();
    if (any) {
      if (const auto yes = desk_->confirm(question()); !yes) return fail(yes.error());
      // It may have taken long to answer.
      if (const auto quiet = check_quiet(); !quiet) return fail(quiet.error());
    }
    List out;
    for (const auto& job : jobs_) {
      out.emplace_back(carry_out(job));
      if (!desk_->errors.empty() && desk_->errors.back().code == Errc::interrupted) break;
    }
    return Value(std::move(out));
  }

 private:
  /// Of a change that was cut off only its own record is the way back; until then every other change says so.
  Result<void> take_up_record() {
    if (desk_->nodes.size() == 1 && !how_.file.empty()) {
      PdoRecord record(*desk_, desk_->nodes.front());
      const auto journal = record.take_up(how_.file);
      if (!journal) return fail(journal.error());
      if (*journal) {
        undone_ = Undone{std::move(record), **journal};
        how_.keep = how_.keep || undone_->journal.keep;
        how_.unlock = how_.unlock || undone_->journal.unlock;
        return {};
      }
    }
    tell_cut_off_changes(*desk_);
    return {};
  }

  Result<void> plan_all() {
    const auto read = session::read_pdo_values(*desk_->session, desk_->profile, desk_->nodes);
    for (std::size_t i = 0; i < read.size(); ++i) {
      if (!read[i]) return fail(read[i].error());
      Job job{{desk_->nodes[i], *read[i], session::pdos_of(*read[i])}, {}, {}, {}};
      const auto wanted = (*edit_)(job.present);
      if (!wanted) return fail(wanted.error());
      job.wanted = *wanted;
      if (const auto fits = check(job); !fits) {
        auto error = fits.error();
        error.node = job.present.node;
        error.message = message("node {}: {}", node_name(job.present.node), error.message);
        return fail(std::move(error));
      }
      if (const auto planned = plan(job); !planned) return planned;
      jobs_.push_back(std::move(job));
    }
    return undone_ ? Result<void>() : check_bus();
  }

  Result<void> check_bus() const {
    std::vector<PdoNeighbour> nodes;
    for (const auto& job : jobs_) {
      auto after = job.present.values;
      for (const auto& [object, data] : job.values) after[object] = data;
      nodes.push_back({job.present.node, job.present.pdos, session::pdos_of(after)});
    }
    return check_neighbours(*desk_, nodes);
  }

  Result<void> check(const Job& job) const {
    auto all = job.present.pdos;
    for (const auto& pdo : job.wanted.pdos)
      for (auto& each : all)
        if (same_pdo(each, pdo)) each = pdo;
    for (const auto& pdo : job.wanted.pdos) {
      const auto& now = *job.present.find(pdo);
      if (pdo.entries != now.entries)
        if (const auto fits = show::check_mapping(*desk_->profile, pdo); !fits) return fits;
      if (const auto fits = show::check_communication(*desk_->profile, now, pdo, all); !fits) return fits;
    }
    return {};
  }

  Result<void> plan(Job& job) {
    for (const auto& pdo : job.wanted.pdos)
      for (auto& [object, data] : session::values_of(pdo, job.present.values))
        job.values.emplace(object, data);
    for (const auto& [object, data] : job.wanted.assignments) job.values.emplace(object, data);
    const auto objects = job.values.size();
    if (how_.keep) session::add_stored_copies(*desk_->profile, job.present.node, job.values);
    copies_ = copies_ || job.values.size() > objects;
    const auto complete =
        session::complete(*desk_->session, job.present.node, job.present.values, job.values);
    if (complete) job.plan = session::plan_writes(desk_->profile, job.present.values, job.values);
    return complete;
  }

  Result<void> check_quiet() const {
    for (const auto& job : jobs_)
      if (const auto quiet = session::check_not_energised(*desk_->session, job.present.node); !quiet)
        return quiet;
    return {};
  }

  std::string question() const {
    std::string pdos;
    std::string nodes;
    for (const auto& job : jobs_) append(nodes, formatted("{}", job.present.node));
    for (const auto& pdo : jobs_.front().wanted.pdos) append(pdos, canopen::name(pdo.direction, pdo.number));
    return jobs_.front().wanted.pdos.size() == 1
               ? formatted("Change {} of node {}? Other users of it must be changed too.", pdos, nodes)
               : formatted("Change {} of node {}? Other users of them must be changed too.", pdos, nodes);
  }

  /// What changes it, and what the family's password and memory need around it.
  Result<Value> frames() const {
    session::Rehearsal out;
    for (const auto& job : jobs_) {
      if (is_idle(job)) continue;
      const auto node = job.present.node;
      const bool pause = session::needs_pre_operational(desk_->profile, job.plan);
      const auto state = [&](session::NodeState wanted, std::string when) {
        out.add(session::planned_state(node, wanted, std::move(when)));
      };
      session::StorageScope storage(*desk_->session, desk_->profile, node);
      storage.rehearse(out);
      if (pause) state(session::NodeState::pre_operational, "if it is operational");
      if (const auto opened = storage.open(how_.keep, how_.unlock, true); !opened)
        return fail(opened.error());
      for (const auto& step : job.plan) out.add(session::planned_write({node, step.object, step.data}));
      (void)storage.close(true, job.plan.size());
      if (pause) state(session::NodeState::operational, "if it was operational");
    }
    return show::planned_messages(*desk_, out.messages());
  }

  bool is_idle(const Job& job) const { return job.plan.empty() && !how_.keep; }

  Result<void> make_ready(const Job& job, PdoRecord& before) const {
    if (undone_) return settings::put_means_back(*desk_->session, undone_->journal);
    return is_idle(job) ? Result<void>() : before.begin(job.present.values, how_.keep, how_.unlock);
  }

  Record carry_out(const Job& job) {
    auto before = undone_ ? undone_->record : PdoRecord(*desk_, job.present.node);
    if (const auto ready = make_ready(job, before); !ready) {
      desk_->errors.push_back(ready.error());
      return record_present(job, "not changed", job.present.pdos);
    }
    if (is_idle(job)) {
      before.settle();
      return record(job, "already as requested, nothing was written", {});
    }
    const auto outcome =
        session::change_pdos(*desk_->session, desk_->profile, job.present.node, job.present.values,
                             job.values, {.keep = how_.keep, .unlock = how_.unlock});
    for (const auto& notice : outcome.notices) desk_->notices.push_back(notice);
    end(before, outcome);
    if (!outcome.failure) return record(job, "written, read back", kept(outcome));
    auto failure = *outcome.failure;
    if (auto hint = other_pdo_hint(*desk_->profile, job.present, job.wanted, failure); !hint.empty())
      failure.hint = std::move(hint);
    desk_->errors.push_back(std::move(failure));
    if (outcome.all_written) return record(job, "written, read back; keeping it failed", {});
    if (outcome.rolled_back)
      return record_present(job, "not changed: everything is as it was", job.present.pdos);
    add_astray(job, outcome);
    const auto now = session::read_pdos(*desk_->session, desk_->profile, job.present.node);
    return record_present(job, "failed; see the errors", now.value_or(std::vector<Pdo>()));
  }

  /// The record goes away when nothing is left to be put back by it.
  void end(PdoRecord& before, const session::RestoreOutcome& outcome) {
    bool settled = !outcome.failure || (!undone_ && (outcome.all_written || outcome.rolled_back));
    // A trial leaves the switch of the memory at the RAM.
    if (settled && undone_)
      if (const auto back = settings::put_means_back(*desk_->session, undone_->journal); !back) {
        desk_->errors.push_back(back.error());
        settled = false;
      }
    if (settled) return before.settle();
    for (auto& notice : before.notices()) desk_->notices.push_back(std::move(notice));
  }

  void add_astray(const Job& job, const session::RestoreOutcome& outcome) {
    for (const auto object : outcome.astray) {
      desk_->errors.push_back(drive_error(
          Errc::negative, job.present.node, object, "it may not hold its old value",
          "`pdo show` reads it once the node answers; a restart of the drive loads the stored value"));
    }
  }

  /// Whether it survives power-off: where a family has neither 1010h nor stored copies, no manual tells.
  Value kept(const session::RestoreOutcome& outcome) {
    // CiA 301, 7.5.2.13: what is not stored by 1010h is lost.
    const auto& profile = *desk_->profile;
    const bool stores =
        profile.rules.store.objects && profile.dictionary.find({objects::kStoreIndex, 1}) != nullptr;
    if (outcome.kept == session::Kept::unknown) return stores && !how_.keep ? Value(false) : Value();
    const bool told = desk_->profile->rules.store.objects || copies_;
    if (outcome.kept == session::Kept::yes && !told) {
      desk_->notices.emplace_back(
          "whether this drive keeps its PDOs is not stated: use `pdo show` after a power cycle");
      return {};
    }
    return outcome.kept == session::Kept::yes;
  }

  /// What the drive has of the PDOs that were to change.
  Record record_present(const Job& job, std::string_view state, const std::vector<Pdo>& present) const {
    std::vector<Pdo> shown;
    for (const auto& pdo : job.wanted.pdos)
      for (const auto& each : present)
        if (same_pdo(each, pdo)) shown.push_back(each);
    return record(job, state, {}, shown);
  }

  Record record(const Job& job, std::string_view state, Value kept) const {
    return record(job, state, std::move(kept), job.wanted.pdos);
  }

  Record record(const Job& job, std::string_view state, Value kept, std::span<const Pdo> shown) const {
    Record out{{"node", job.present.node},
               {"result", state},
               {"kept", kept, Show::json},
               {"kept", state.starts_with("written") ? settings::kept_text(kept) : Value(), Show::text}};
    List pdos;
    for (const auto& pdo : shown) {
      const auto lines = show::pdo_lines(desk_->profile, pdo, job.present.node, desk_->chinese,
                                         !desk_->session->network().is_ring());
      for (std::size_t i = 0; i < lines.size(); ++i)
        out.push_back(
            {i == 0 ? canopen::name(pdo.direction, pdo.number) : std::string(), lines[i], Show::text});
      pdos.emplace_back(show::pdo_record(desk_->profile, pdo, job.present.node, desk_->chinese));
    }
    out.push_back({"pdos", std::move(pdos), Show::json});
    return out;
  }

  show::Desk* desk_;
  const PdoEdit* edit_;
  PdoChanging how_;
  bool copies_ = false;
  std::vector<Job> jobs_;
  std::optional<Undone> undone_;
};

}  // namespace

Result<Value> change_pdos(show::Desk& desk, const PdoEdit& edit, const PdoChanging& how) {
  return Changing(desk, edit, how).run();
}

}  // namespace servoctl::pdo
