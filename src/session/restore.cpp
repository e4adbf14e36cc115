#include "session/restore.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <set>

#include "session/deaf.hpp"
#include "session/write.hpp"

namespace servoctl::session {
namespace {

constexpr std::uint32_t kInvalid = 0x8000'0000;
/// A node that has missed so many answers in a row is not asked on.
constexpr int kMostSilences = 2;

bool is_communication(std::uint16_t index) {
  return (index >= 0x1400 && index <= 0x15FF) || (index >= 0x1800 && index <= 0x19FF);
}
bool is_mapping(std::uint16_t index) {
  return (index >= 0x1600 && index <= 0x17FF) || (index >= 0x1A00 && index <= 0x1BFF);
}
/// 1400h stands for itself and its mapping 1600h.
std::uint16_t block_of(std::uint16_t index) {
  return is_mapping(index) ? static_cast<std::uint16_t>(index - 0x200) : index;
}

/// The writes of one PDO.
class PdoPlan {
 public:
  PdoPlan(const drive::Profile* profile, const Values& present, const Values& wanted,
          std::uint16_t communication)
      : by_count_(profile != nullptr && profile->rules.pdo.disable_by_count),
        present_(&present),
        wanted_(&wanted),
        communication_(communication),
        mapping_(static_cast<std::uint16_t>(communication + 0x200)) {}

  void add_to(std::vector<PlannedWrite>& out) {
    const ObjectAddress cob_id{communication_, 1};
    const bool valid = has(cob_id) && (number(*present_, cob_id) & kInvalid) == 0;
    const bool move_id = differs(cob_id);
    const bool switch_off = valid && (!by_count_ || move_id);
    if (switch_off) out.push_back({cob_id, store_le(number(*present_, cob_id) | kInvalid, 4)});
    if (mapping_differs()) add_mapping(out);
    for (const auto& [object, data] : *wanted_)
      if (object.index == communication_ && object.sub > 1 && differs(object)) out.push_back({object, data});
    if (has(cob_id) && (switch_off || move_id)) out.push_back({cob_id, wanted_->at(cob_id)});
  }

 private:
  static std::uint32_t number(const Values& values, ObjectAddress object) {
    return static_cast<std::uint32_t>(load_le(values.at(object)));
  }
  bool has(ObjectAddress object) const { return wanted_->count(object) > 0 && present_->count(object) > 0; }
  bool differs(ObjectAddress object) const {
    return has(object) && present_->at(object) != wanted_->at(object);
  }
  bool mapping_differs() const {
    return std::any_of(wanted_->begin(), wanted_->end(), [&](const auto& value) {
      return value.first.index == mapping_ && differs(value.first);
    });
  }
  void add_mapping(std::vector<PlannedWrite>& out) const {
    const ObjectAddress count{mapping_, 0};
    if (has(count) && number(*present_, count) != 0) out.push_back({count, store_le(0, 1)});
    for (const auto& [object, data] : *wanted_)
      if (object.index == mapping_ && object.sub > 0 && differs(object)) out.push_back({object, data});
    if (has(count) && number(*wanted_, count) != 0) out.push_back({count, wanted_->at(count)});
  }

  bool by_count_;
  const Values* present_;
  const Values* wanted_;
  std::uint16_t communication_;
  std::uint16_t mapping_;
};

/// One restore under way.
class Run {
 public:
  Run(Session& session, const drive::Profile* profile, std::uint8_t node, const Values& present,
      const Values& wanted)
      : session_(&session), profile_(profile), node_(node), present_(&present), wanted_(&wanted) {}

  RestoreOutcome carry_out(const RestoreOptions& options) {
    StorageScope storage(*session_, profile_, node_);
    Result<void> done = storage.open(options.keep, options.unlock, true);
    const auto plan = plan_writes(profile_, *present_, *wanted_);
    for (const auto& step : plan) touched_.insert(step.object);
    if (done) done = write(plan, out_.writes);
    if (done) done = check();
    out_.all_written = done.has_value();
    if (!done) {
      out_.failure = done.error();
      if (options.roll_back) go_back();
    }
    const auto kept = storage.close(!out_.failure);
    out_.notices = storage.notices();
    if (kept)
      out_.kept = *kept;
    else if (!out_.failure)
      out_.failure = kept.error();
    return std::move(out_);
  }

 private:
  Result<void> write(const std::vector<PlannedWrite>& plan, std::size_t& count) {
    for (const auto& step : plan) {
      const SdoRequest request{node_, step.object, step.data};
      const auto written = write_all(*session_, std::span(&request, 1), true).front();
      if (!written) return tl::unexpected<Error>(written.error());
      ++count;
    }
    return {};
  }

  /// A drive that restarted in between has forgotten what was written first.
  Result<void> check() {
    for (const auto object : touched_) {
      const auto found = session_->upload(node_, object);
      if (!found) return tl::unexpected<Error>(found.error());
      if (*found == wanted_->at(object)) continue;
      Error error;
      error.code = Errc::negative;
      error.node = node_;
      error.object = object;
      error.message =
          fmt::format("node {}, object {}: it was read back as written, and holds another value now", node_,
                      to_string(object));
      error.hint = "did the drive restart in between? another master may write to it as well";
      return fail(std::move(error));
    }
    return {};
  }

  /// Reads where things stand, puts back what is not as it was, and reads again. Deaf to Ctrl-C.
  void go_back() {
    const Deaf deaf(*session_);
    auto now = read_touched();
    for (const auto object : touched_)
      if (now.count(object) == 0) now.emplace(object, other_than(present_->at(object)));
    std::size_t ignored = 0;
    if (!silent_) (void)write(plan_writes(profile_, now, *present_), ignored);
    now = silent_ ? Values{} : read_touched();
    for (const auto object : touched_) {
      const auto found = now.find(object);
      if (found == now.end() || found->second != present_->at(object)) out_.astray.push_back(object);
    }
    out_.rolled_back = out_.astray.empty();
  }

  /// Stands for a value that could not be read: it is written back all the same.
  static Bytes other_than(Bytes bytes) {
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
  bool silent_ = false;  ///< The node has stopped answering.
  RestoreOutcome out_;
};

}  // namespace

std::vector<PlannedWrite> plan_writes(const drive::Profile* profile, const Values& present,
                                      const Values& wanted) {
  std::vector<PlannedWrite> out;
  std::uint16_t planned = 0;
  const auto differs = [&](ObjectAddress object, const Bytes& data) {
    const auto found = present.find(object);
    return found != present.end() && found->second != data;
  };
  for (const auto& each : wanted) {
    const auto object = each.first;
    const auto& data = each.second;
    if (!differs(object, data)) continue;
    if (!is_communication(object.index) && !is_mapping(object.index)) {
      out.push_back({object, data});
      continue;
    }
    const auto block = block_of(object.index);
    if (block == planned) continue;
    // A block is planned where its first difference is met, communication or mapping.
    const bool met = std::any_of(wanted.begin(), wanted.end(), [&](const auto& value) {
      return value.first < object && block_of(value.first.index) == block &&
             differs(value.first, value.second);
    });
    if (met) continue;
    planned = block;
    PdoPlan(profile, present, wanted, block).add_to(out);
  }
  return out;
}

RestoreOutcome restore(Session& session, const drive::Profile* profile, std::uint8_t node,
                       const Values& present, const Values& wanted, const RestoreOptions& options) {
  return Run(session, profile, node, present, wanted).carry_out(options);
}

}  // namespace servoctl::session
