#include "session/pdo_change.hpp"

#include <algorithm>
#include <array>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/cia402.hpp"
#include "drive/standard_objects.hpp"
#include "session/option_scope.hpp"
#include "session/state_pause.hpp"

namespace servoctl::session {
namespace {

using canopen::Pdo;
using drive::PdoRules;

/// An entry of a mapping behind its count: whatever it holds means nothing.
bool is_unused(ObjectAddress object, const Values& values) {
  const auto count = values.find({object.index, 0});
  return is_pdo_mapping(object.index) && object.sub > 0 && count != values.end() &&
         object.sub > load_le(count->second);
}

/// The identifier in an object that holds a COB-ID (CiA 301, 7.5.2.15).
constexpr std::uint64_t kCobIdBits = 0x1FFF'FFFF;

/// How one attempt goes about it.
struct Way {
  bool pre_operational = false;
  bool by_count = false;
};

/// A refusal that says something about the object or the value: it is the same in every state of the node.
bool is_no_matter_of_state(std::uint32_t abort_code) {
  using namespace canopen::sdo_abort;
  constexpr std::array kSuch{kWriteOnly, kReadOnly, kNoObject, kNotMappable, kPdoLength,
                             kLength,    kTooLong,  kTooShort, kNoSubIndex};
  return std::find(kSuch.begin(), kSuch.end(), abort_code) != kSuch.end();
}

/// One change of one node, by as many ways as it takes.
class Change {
 public:
  Change(Session& session, const drive::Profile* profile, std::uint8_t node, const Values& present,
         const Values& wanted, const RestoreOptions& options)
      : session_(&session),
        profile_(profile),
        node_(node),
        present_(&present),
        wanted_(&wanted),
        options_(options) {}

  RestoreOutcome run() {
    Way way;
    way.pre_operational = needs_pre_operational(profile_, plan_writes(profile_, *present_, *wanted_));
    for (;;) {
      auto outcome = attempt(way);
      const auto next = next_way(way, outcome);
      if (!next) {
        outcome.notices.insert(outcome.notices.begin(), notices_.begin(), notices_.end());
        return outcome;
      }
      for (auto& notice : outcome.notices) notices_.push_back(std::move(notice));
      way = *next;
    }
  }

 private:
  RestoreOutcome attempt(const Way& way) {
    StatePause pause(*session_, node_);
    if (way.pre_operational)
      if (const auto entered = pause.enter(); !entered) {
        RestoreOutcome out;
        out.failure = entered.error();
        out.rolled_back = true;
        return out;
      }
    auto by_count = profile_ == nullptr ? drive::Profile{} : *profile_;
    by_count.rules.pdo.disable_by_count = true;
    by_count.rules.pdo.inhibit_while_valid = true;  // The COB-ID cannot be written.
    auto out = restore(*session_, way.by_count ? &by_count : profile_, node_, *present_, *wanted_, options_);
    // What a node refused in the state it was in, and answers otherwise now, it refused as operational.
    if (refused_state_ && (!out.failure || out.failure->abort_code != canopen::sdo_abort::kDeviceState))
      pause.note_before(NodeState::operational);
    if (out.failure && !out.astray.empty()) put_back_what_is_used(out);
    const auto left = pause.leave(out.astray.empty());
    if (!left && !out.failure) out.failure = left.error();
    out.notices.insert(out.notices.end(), pause.notices().begin(), pause.notices().end());
    return out;
  }

  /// A drive may refuse the values that stood in entries behind the count, and with them the way back: they
  /// are of no importance. Deaf to Ctrl-C.
  void put_back_what_is_used(RestoreOutcome& out) {
    const Deaf deaf(*session_);
    Values used;
    Values now;
    std::vector<SdoRequest> questions;
    for (const auto object : touched_by(plan_writes(profile_, *present_, *wanted_), *present_))
      if (!is_unused(object, *present_)) {
        used.emplace(object, present_->at(object));
        questions.push_back({.node = node_, .object = object});
      }
    const auto answers = session_->transfer(questions);
    for (std::size_t i = 0; i < answers.size(); ++i)
      if (answers[i]) now.emplace(questions[i].object, *answers[i]);
    if (now.size() < used.size()) return;
    if (now != used) (void)restore(*session_, profile_, node_, now, used, {.roll_back = false});
    std::erase_if(out.astray, [&](ObjectAddress object) {
      if (used.count(object) == 0) return true;
      const auto found = session_->upload(node_, object);
      return found && *found == used.at(object);
    });
    out.rolled_back = out.astray.empty();
  }

  /// What else may be tried after a refusal that left everything as it was.
  std::optional<Way> next_way(const Way& way, const RestoreOutcome& outcome) {
    const bool generic = profile_ == nullptr || profile_->is_generic();
    if (!generic || !outcome.failure || outcome.failure->code != Errc::sdo_abort || !outcome.rolled_back)
      return std::nullopt;
    const auto object = outcome.failure->object.value_or(ObjectAddress{});
    const auto place = canopen::pdo_at(object.index);
    if (!place) return std::nullopt;
    auto next = way;
    const auto code = outcome.failure->abort_code.value_or(0);
    if (!way.pre_operational && !is_no_matter_of_state(code)) {
      // A drive that can move is not stopped on a guess; one that does not tell may be.
      if (!check_not_energised(*session_, node_)) return std::nullopt;
      next.pre_operational = true;
      refused_state_ = code == canopen::sdo_abort::kDeviceState;
      note(*outcome.failure, "pre-operational");
      return next;
    }
    if (way.by_count || place->mapping || object.sub != 1 || present_->at(object) != wanted_->at(object))
      return std::nullopt;
    next.by_count = true;
    note(*outcome.failure, "with the COB-ID left alone");
    return next;
  }

  void note(const Error& refusal, std::string_view how) {
    notices_.push_back(message("{}; tried again {}", refusal.message, how));
  }

  Session* session_;
  const drive::Profile* profile_;
  std::uint8_t node_;
  const Values* present_;
  const Values* wanted_;
  RestoreOptions options_;
  std::vector<Message> notices_;
  bool refused_state_ = false;  ///< Where the node was not put into a state: because of the one it was in.
};

void set(Values& out, const Values& present, ObjectAddress object, std::uint64_t value) {
  if (const auto found = present.find(object); found != present.end())
    out.insert_or_assign(object, store_le(value, std::min<std::size_t>(found->second.size(), 8)));
}

}  // namespace

Values values_of(const Pdo& pdo, const Values& present) {
  Values out;
  const auto communication = pdo.communication_index();
  const auto mapping = pdo.mapping_index();
  set(out, present, {communication, 1}, pdo.cob_id);
  set(out, present, {communication, 2}, pdo.type);
  if (pdo.inhibit) set(out, present, {communication, 3}, *pdo.inhibit);
  if (pdo.event) set(out, present, {communication, 5}, *pdo.event);
  if (pdo.sync_start) set(out, present, {communication, 6}, *pdo.sync_start);
  set(out, present, {mapping, 0}, pdo.entries.size());
  for (std::size_t i = 0; i < pdo.entries.size(); ++i)
    out.emplace(ObjectAddress{mapping, static_cast<std::uint8_t>(i + 1)},
                store_le(canopen::mapping_of(pdo.entries[i]), 4));
  return out;
}

void add_stored_copies(const drive::Profile& profile, std::uint8_t node, Values& wanted) {
  const auto& with_node = profile.rules.mirror_add_node_id;
  for (const auto& parameter : profile.parameters) {
    // Others are the same value under another number, in force at once: nothing is copied at a start.
    if (!parameter.mirror || !parameter.object || parameter.effect != od::Effect::restart) continue;
    const auto found = wanted.find(*parameter.mirror);
    const auto size = od::size_of(parameter.type);
    if (found == wanted.end() || !size) continue;
    const bool added = std::count(with_node.begin(), with_node.end(), *parameter.mirror) > 0;
    auto value = load_le(found->second);
    if (added && (value & kCobIdBits) >= node) value -= node;  // One that is off and has no number stays off.
    wanted.insert_or_assign(*parameter.object, store_le(value, *size));
  }
}

Result<void> complete(Session& session, std::uint8_t node, Values& present, const Values& wanted) {
  std::vector<SdoRequest> questions;
  for (const auto& value : wanted)
    if (present.count(value.first) == 0) questions.push_back({.node = node, .object = value.first});
  const auto answers = session.transfer(questions);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const auto object = questions[i].object;
    const bool entry = is_pdo_mapping(object.index) && object.sub > 0;
    if (!answers[i] && !(entry && answers[i].error().code == Errc::sdo_abort))
      return fail(answers[i].error());
    present.emplace(object, answers[i] ? *answers[i] : Bytes(wanted.at(object).size(), 0));
  }
  return {};
}

Result<void> check_not_energised(Session& session, std::uint8_t node) {
  const auto word = session.upload(node, objects::kStatusword);
  if (!word && word.error().code != Errc::sdo_abort) return fail(word.error());
  if (!word || !drive::is_energised(drive::decode_state(static_cast<std::uint16_t>(load_le(*word)))))
    return {};
  return fail(drive_error(Errc::refused, node, "it is energised; its PDOs cannot be changed now",
                          "disable it first"));
}

bool needs_pre_operational(const drive::Profile* profile, const std::vector<PlannedWrite>& plan) {
  if (profile == nullptr) return false;
  const auto& rules = profile->rules.pdo;
  return std::any_of(plan.begin(), plan.end(), [&](const PlannedWrite& write) {
    const auto place = canopen::pdo_at(write.object.index);
    return place && (place->mapping ? rules.mapping : rules.parameters) == PdoRules::When::not_operational;
  });
}

RestoreOutcome change_pdos(Session& session, const drive::Profile* profile, std::uint8_t node,
                           const Values& present, const Values& wanted, const RestoreOptions& options) {
  return Change(session, profile, node, present, wanted, options).run();
}

}  // namespace servoctl::session
