#include "session/restore.hpp"

#include <algorithm>
#include <set>

#include "base/format.hpp"
#include "canopen/pdo.hpp"
#include "drive/standard_objects.hpp"
#include "session/option_scope.hpp"
#include "session/write.hpp"

namespace servoctl::session {
namespace {

/// A node that has missed so many answers in a row is not asked on.
constexpr int kMostSilences = 2;

/// One restore under way.
class Run {
 public:
  Run(Session& session, const drive::Profile* profile, std::uint8_t node, const Values& present,
      const Values& wanted)
      : session_(&session), profile_(profile), node_(node), present_(&present), wanted_(&wanted) {}

  RestoreOutcome carry_out(const RestoreOptions& options) {
    boots_ = session_->watch().boots(node_);
    StorageScope storage(*session_, profile_, node_);
    Result<void> done = storage.open(options.keep, options.unlock, true);
    const auto plan = planned(storage, options);
    touched_ = touched_by(plan, *present_);
    if (done) done = write(plan, out_.writes);
    if (storage.worked_in_ram()) note_flash(sent_);
    if (done) done = check();
    if (done) done = check_restart();
    out_.all_written = done.has_value();
    if (!done) {
      out_.failure = done.error();
      if (options.roll_back) take_back(storage);
    }
    // Nothing that was taken back is lost at power-off.
    const auto kept = storage.close(!out_.failure, is_as_before() ? 0 : out_.writes);
    for (const auto& notice : storage.notices()) out_.notices.push_back(notice);
    end(kept);
    return std::move(out_);
  }

  Result<void> rehearse(const RestoreOptions& options, Rehearsal& rehearsal) {
    StorageScope storage(*session_, profile_, node_);
    storage.rehearse(rehearsal);
    if (const auto opened = storage.open(options.keep, options.unlock, true); !opened) return opened;
    const auto plan = planned(storage, options);
    for (const auto& step : plan) rehearsal.add(planned_write({node_, step.object, step.data}));
    const auto closed = storage.close(true, plan.size());
    return closed ? Result<void>() : fail(closed.error());
  }

 private:
  std::vector<PlannedWrite> planned(const StorageScope& storage, const RestoreOptions& options) {
    return plan_writes(profile_, storage.worked_in_ram() ? in_flash(options.unlock) : *present_, *wanted_);
  }

  /// What the flash of a drive that worked in its RAM holds: unknown, so everything of the vendor's is
  /// written and not only what differs. What stands behind a password that is not given cannot have been
  /// tried.
  Values in_flash(bool unlocked) {
    std::set<ObjectAddress> locked;
    for (const auto& id : profile_->rules.store.locked)
      if (const auto* parameter = profile_->parameter(id); parameter != nullptr && parameter->object)
        locked.insert(*parameter->object);
    Values out = *present_;
    for (auto& [object, data] : out)
      if (object.index >= 0x2000 && object.index < 0x6000 && (unlocked || locked.count(object) == 0))
        data = other_than(object, data);
    out_.notices.push_back(message(
        "node {}: it was working in RAM, so every value is written to flash, not only those that differ",
        node_name(node_)));
    return out;
  }

  /// In the RAM and in the flash.
  bool is_as_before() const { return out_.rolled_back && out_.in_flash.empty(); }

  void end(const Result<Kept>& kept) {
    if (!kept && out_.failure) {
      out_.failure->message += "; " + kept.error().message;
    } else if (!kept) {
      out_.failure = kept.error();
      look_again();
    } else if (out_.failure && *kept == Kept::yes) {
      // A switch keeps each value as it is written: some of these, then, unless all were taken back.
      out_.kept = is_as_before() ? Kept::no : Kept::unknown;
    } else {
      out_.kept = *kept;
    }
  }

  /// Communication objects and the controlword do not go through the switch of the memory.
  void note_flash(const std::set<ObjectAddress>& objects) {
    out_.in_flash.clear();
    for (const auto object : objects)
      if (object.index >= 0x2000 && object != objects::kControlword) out_.in_flash.push_back(object);
  }

  Result<void> write(const std::vector<PlannedWrite>& plan, std::size_t& count) {
    for (const auto& step : plan) {
      const SdoRequest request{node_, step.object, step.data};
      const auto written = write_all(*session_, std::span(&request, 1), true).front();
      if (write_end(written, step.object) != WriteEnd::not_written) sent_.insert(step.object);
      if (!written) return fail(written.error());
      ++count;
    }
    return {};
  }

  /// A drive that restarted in between has forgotten what was written first.
  Result<void> check() {
    for (const auto object : touched_) {
      if (wanted_->count(object) == 0) continue;
      const auto found = session_->upload(node_, object);
      if (!found) return fail(found.error());
      if (*found == wanted_->at(object)) continue;
      return fail(drive_error(Errc::negative, node_, object,
                              "it was read back as written, but now holds another value",
                              "did the drive restart in between, or does another master write to it?"));
    }
    return {};
  }

  /// One that restarts while its values are read for the last time has shown some of them before it.
  Result<void> check_restart() const {
    if (session_->watch().boots(node_) == boots_) return {};
    return fail(drive_error(Errc::negative, node_, "it restarted during the writes",
                            "is its supply stable? Values it does not keep by itself are lost"));
  }

  /// Storing failed: a drive that restarted over it may have forgotten what was written. What is read tells;
  /// one that does not answer any more is as it was read back last.
  void look_again() {
    const Deaf deaf(*session_);
    const auto now = read_touched();
    const auto is_other = [&](const auto& value) {
      const auto wanted = wanted_->find(value.first);
      return wanted != wanted_->end() && wanted->second != value.second;
    };
    if (std::none_of(now.begin(), now.end(), is_other)) return;
    out_.all_written = false;
    for (const auto object : touched_) {
      const auto found = now.find(object);
      if (found == now.end() || found->second != present_->at(object)) out_.astray.push_back(object);
    }
    out_.rolled_back = out_.astray.empty();
  }

  /// To the memory that the drive worked with. Where its flash could not be left nothing is put back: what is
  /// not as it was is named.
  void take_back(StorageScope& storage) {
    const bool of_ram = storage.worked_in_ram();
    const auto left = storage.leave_flash();
    const auto boots = session_->watch().boots(node_);
    go_back(left.has_value());
    // One that restarted meanwhile may work with its flash again.
    if (of_ram && session_->watch().boots(node_) != boots) note_flash(touched_);
  }

  /// Reads where things stand, puts back what is not as it was, and reads again. Deaf to Ctrl-C.
  void go_back(bool may_write) {
    const Deaf deaf(*session_);
    auto now = read_touched();
    for (const auto object : touched_)
      if (now.count(object) == 0) now.emplace(object, other_than(object, present_->at(object)));
    std::size_t ignored = 0;
    if (!silent_ && may_write) (void)write(plan_writes(profile_, now, *present_), ignored);
    now = silent_ ? Values{} : read_touched();
    for (const auto object : touched_) {
      const auto found = now.find(object);
      if (found == now.end() || found->second != present_->at(object)) out_.astray.push_back(object);
    }
    out_.rolled_back = out_.astray.empty();
  }

  /// Stands for a value that could not be read: it is written back all the same. Of a COB-ID only bit 31
  /// is another, so that no made-up CAN-ID is ever sent.
  static Bytes other_than(ObjectAddress object, Bytes bytes) {
    const auto pdo = canopen::pdo_at(object.index);
    if (pdo && !pdo->mapping && object.sub == 1 && bytes.size() == 4) {
      bytes[3] ^= 0x80;
      return bytes;
    }
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(~byte);
    return bytes;
  }

  /// What the plan is about, as far as the node answers.
  Values read_touched() {
    Values out;
    int silences = 0;
    for (const auto object : touched_) {
      auto answer = session_->upload(node_, object);
      // The late answer to what was interrupted may have been taken for an answer to this.
      if (!answer && answer.error().code == Errc::protocol) answer = session_->upload(node_, object);
      if (answer) {
        out.emplace(object, *answer);
        silences = 0;
      } else if (answer.error().code != Errc::sdo_abort && ++silences > kMostSilences) {
        silent_ = true;
        break;
      }
    }
    return out;
  }

  Session* session_;
  const drive::Profile* profile_;
  std::uint8_t node_;
  const Values* present_;
  const Values* wanted_;
  std::set<ObjectAddress> touched_;
  std::set<ObjectAddress> sent_;  ///< What was, or may have been, written.
  std::uint32_t boots_ = 0;       ///< Boot-ups heard before the first write.
  bool silent_ = false;           ///< The node has stopped answering.
  RestoreOutcome out_;
};

}  // namespace

RestoreOutcome restore(Session& session, const drive::Profile* profile, std::uint8_t node,
                       const Values& present, const Values& wanted, const RestoreOptions& options) {
  return Run(session, profile, node, present, wanted).carry_out(options);
}

Result<void> rehearse_restore(Session& session, const drive::Profile* profile, std::uint8_t node,
                              const Values& present, const Values& wanted, const RestoreOptions& options,
                              Rehearsal& rehearsal) {
  return Run(session, profile, node, present, wanted).rehearse(options, rehearsal);
}

}  // namespace servoctl::session
