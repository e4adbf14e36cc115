#include "session/object_scan.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"

namespace servoctl::session {
namespace {

namespace abort_of = canopen::sdo_abort;

constexpr unsigned kLastSub = 0xFE;  // FFh describes the structure (CiA 301, 7.4.5.2).
/// Sub-indices that hardly any object has.
constexpr unsigned kImprobableSub = 0x9B;
/// Indexes that hardly any drive has, nowhere near others.
constexpr std::uint16_t kImprobable[] = {0x5E3B, 0x4D71};
/// A larger number in sub-index 0 counts only where the last of so many is there.
constexpr unsigned kCredible = 32;
/// As many indexes are asked for at a time; the state is kept after so many of these parts.
constexpr std::size_t kPart = 16;
constexpr std::size_t kPartsKept = 32;
/// So many objects in succession without an answer are too many to wait for.
constexpr std::size_t kMostSilent = 16;
/// For an axis that was enabled to come to a stop after a fault.
constexpr Duration kReaction = std::chrono::seconds(10);
constexpr Duration kBetweenLooks = std::chrono::milliseconds(50);

bool is_write_only(const Result<Bytes>& answer) {
  return !answer && answer.error().abort_code == abort_of::kWriteOnly;
}

bool is_silent(const Result<Bytes>& answer) { return !answer && answer.error().code == Errc::timeout; }

bool is_there(const Result<Bytes>& answer) { return answer || is_write_only(answer); }

/// 0800 0020h to 0024h: the object exists, and cannot be read now.
bool is_of_the_moment(std::uint32_t code) {
  return code >= abort_of::kCannotStore && code <= abort_of::kNoData;
}

/// What sub-index 0 may count; 0 for none. Some drives give it more than one byte.
unsigned count_in(const Result<Bytes>& first) {
  if (!first || first->empty() || first->size() > 8) return 0;
  const auto value = load_le(*first);
  return value <= kLastSub ? static_cast<unsigned>(value) : 0U;
}

std::optional<std::uint32_t> common_code(const Result<Bytes>& one, const Result<Bytes>& other) {
  const bool same = !one && !other && one.error().abort_code == other.error().abort_code;
  return same ? one.error().abort_code : std::nullopt;
}

drive::DriveState state_in(const Bytes& statusword) {
  return drive::decode_state(static_cast<std::uint16_t>(load_le(statusword)));
}

std::uint32_t reason_of(const Error& error) {
  if (error.abort_code) return *error.abort_code;
  return error.code == Errc::timeout ? kWasSilent : kAnsweredWrongly;
}

}  // namespace

Error silent_about_absence(std::uint8_t node, ObjectAddress object) {
  return drive_error(
      Errc::timeout, node, object, "no answer; it answers reads of 1000h",
      "a drive that does not answer for what it lacks cannot be scanned: each such index would "
      "cost a timeout; `read` asks for single objects");
}

std::size_t ScanState::indexes() const {
  std::size_t out = 0;
  for (const auto& range : ranges) out += range.last - range.first + 1U;
  return out;
}

std::uint16_t ScanState::index_at(std::size_t place) const {
  for (const auto& range : ranges) {
    const std::size_t count = range.last - range.first + 1U;
    if (place < count) return static_cast<std::uint16_t>(range.first + place);
    place -= count;
  }
  return 0;
}

ObjectScan::ObjectScan(Session& session, std::uint8_t node, ObjectSurvey& survey,
                       std::vector<ObjectAddress> statuswords, ScanState& state)
    : session_(&session),
      node_(node),
      survey_(&survey),
      statuswords_(std::move(statuswords)),
      state_(&state),
      boots_(session.watch().boots(node)) {
  survey.set_longest(kLongestScanned);
}

Result<void> ObjectScan::run(const std::function<Result<void>()>& keep) {
  if (const auto learned = learn_lacking_code(); !learned) return learned;
  const auto total = state_->indexes();
  const auto begun = state_->done;
  for (std::size_t part = 1; state_->done < total; ++part) {
    if (auto scanned = scan_part(std::min(kPart, total - state_->done)); !scanned) {
      (void)keep();
      return scanned;
    }
    if (part % kPartsKept == 0)
      if (const auto kept = keep(); !kept) return kept;
    if (session_->options().list_progress)
      session_->options().list_progress(state_->done - begun, total - begun, session_->now());
  }
  return keep();
}

/// How it answers for what it does not have. Where that is no refusal, or one that objects give as well, a
/// scan would find objects that are none.
Result<void> ObjectScan::learn_lacking_code() {
  const ObjectAddress objects[] = {{kImprobable[0], 0}, {kImprobable[1], 0}};
  const auto answers = survey_->read(objects);
  if (!answers) return fail(answers.error());
  if (is_silent(answers->front()) && is_silent(answers->back()))
    return fail(silent_about_absence(node_, objects[1]));
  if (is_there(answers->front()) && is_there(answers->back()))
    return fail(drive_error(Errc::refused, node_,
                            "it answers reads of any index: a scan cannot find which objects it has"));
  const auto code = common_code(answers->front(), answers->back());
  if (!code || *code == abort_of::kNoObject || *code == abort_of::kNoSubIndex) return {};
  if (is_of_the_moment(*code))
    return fail(drive_error(
        Errc::refused, node_,
        message("it refuses reads of any index with abort {:08X}h, which says nothing about the object",
                *code)));
  lacking_code_ = code;
  return {};
}

/// A part is done as a whole or not at all: of one that failed nothing is kept. After an EMCY it is done as
/// well, because the same reads would raise the next one.
Result<void> ObjectScan::scan_part(std::size_t count) {
  const auto entries = state_->entries.size();
  const auto refusals = state_->refusals.size();
  const auto alarms = session_->watch().alarms(node_);
  std::vector<ObjectAddress> wanted;
  for (std::size_t i = 0; i < count; ++i) wanted.push_back({state_->index_at(state_->done + i), 0});
  const auto words = take_part(wanted);
  const auto quiet = words ? judge_state(*words) : fail(words.error());
  if (quiet) {
    state_->done += count;
    return {};
  }
  state_->entries.resize(entries);
  state_->refusals.resize(refusals);
  const bool is_alarm = quiet.error().code == Errc::refused && session_->watch().alarms(node_) != alarms;
  if (!is_alarm || survey_->goes_on_despite_alarms()) return quiet;
  for (const auto object : wanted) state_->refusals.push_back({object, kRaisedAlarm});
  state_->done += count;
  auto error = quiet.error();
  error.hint = message(
      "see with `status` whether the drive is in a fault; the same command goes on, and leaves out {:04X}h to "
      "{:04X}h",
      wanted.front().index, wanted.back().index);
  return fail(error);
}

/// The statuswords after the reads. Errc::refused is an EMCY, also one that came a little later.
Result<std::vector<Result<Bytes>>> ObjectScan::take_part(const std::vector<ObjectAddress>& wanted) {
  const auto answers = read(wanted);
  if (!answers) return fail(answers.error());
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (const auto taken = take_index(wanted[i].index, (*answers)[i]); !taken) return fail(taken.error());
  return survey_->read(statuswords_);
}

Result<void> ObjectScan::judge_state(const std::vector<Result<Bytes>>& statuswords) {
  for (std::size_t i = 0; i < statuswords.size(); ++i) {
    const auto& word = statuswords[i];
    if (!word) return fail(word.error());
    auto state = Result<drive::DriveState>(state_in(*word));
    if (*state == drive::DriveState::fault_reaction_active) state = end_of_reaction(statuswords_[i]);
    if (!state) return fail(state.error());
    if (*state == drive::DriveState::fault_reaction_active)
      return fail(drive_error(Errc::refused, node_, statuswords_[i],
                              message("the axis still reacts to a fault after {} s: nothing more is read",
                                      std::chrono::duration_cast<std::chrono::seconds>(kReaction).count()),
                              "`status` shows when it has stopped; then the same command goes on"));
    if (drive::is_energised(*state))
      return fail(drive_error(Errc::refused, node_, statuswords_[i],
                              "the axis is enabled now: nothing more is read", "`disable` it first"));
  }
  if (session_->watch().boots(node_) != boots_)
    return fail(drive_error(Errc::refused, node_, "it restarted during the scan: nothing more is read",
                            "if it is the same drive, the same command goes on"));
  return {};
}

/// A motor that turned when the fault came is braked meanwhile. Fault reaction active where it does not end.
Result<drive::DriveState> ObjectScan::end_of_reaction(ObjectAddress statusword) {
  const auto until = session_->now() + kReaction;
  for (;;) {
    if (const auto waited = session_->wait([] { return false; }, session_->now() + kBetweenLooks); !waited)
      return fail(waited.error());
    const auto words = survey_->read(std::span(&statusword, 1));
    if (!words) return fail(words.error());
    if (!words->front()) return fail(words->front().error());
    const auto state = state_in(*words->front());
    if (state != drive::DriveState::fault_reaction_active || session_->now() >= until) return state;
  }
}

Result<void> ObjectScan::take_index(std::uint16_t index, const Result<Bytes>& first) {
  const bool has_no_sub_0 = !first && first.error().abort_code == abort_of::kNoSubIndex;
  if (is_absent(first) && !has_no_sub_0) return {};
  if (!has_no_sub_0) take({index, 0}, first);
  return walk_subs(index, first);
}

/// A drive that does not look at the sub-index answers for each: the object is one value.
Result<void> ObjectScan::walk_subs(std::uint16_t index, const Result<Bytes>& first) {
  const auto counted = count_in(first);
  const auto second = read_one(index, 1);
  if (!second) return fail(second.error());
  if (is_absent(*second)) {
    if (counted <= 1) return {};
    const auto last = counted > kCredible ? read_one(index, counted) : second;
    if (!last) return fail(last.error());
    if (counted > kCredible && !is_there(*last)) return {};
  }
  const auto improbable = read_one(index, kImprobableSub);
  if (!improbable) return fail(improbable.error());
  const auto last = read_one(index, kLastSub);
  if (!last) return fail(last.error());
  const bool all_the_same = first && *second && *improbable && *last && **second == *first &&
                            **improbable == *first && **last == *first;
  if (all_the_same || (is_there(*improbable) && is_there(*last) && counted < kImprobableSub)) return {};
  const auto end_code = common_code(*improbable, *last);
  const bool is_refused_whole = !first && end_code && first.error().abort_code == end_code && !*second &&
                                second->error().abort_code == end_code;
  return is_refused_whole ? Result<void>() : take_subs(index, counted, end_code);
}

/// `end_code`: how the drive refuses sub-indices that this object does not have.
Result<void> ObjectScan::take_subs(std::uint16_t index, unsigned counted,
                                   std::optional<std::uint32_t> end_code) {
  for (unsigned sub = 1; sub <= kLastSub; ++sub) {
    const auto answer = read_one(index, sub);
    if (!answer) return fail(answer.error());
    const bool is_end = is_absent(*answer) || (!*answer && end_code && !is_write_only(*answer) &&
                                               answer->error().abort_code == end_code);
    if (is_end && sub > counted) return {};
    const bool is_gap = is_end && !(end_code && is_of_the_moment(*end_code));
    if (!is_absent(*answer) && !is_gap) take({index, static_cast<std::uint8_t>(sub)}, *answer);
  }
  return {};
}

Result<std::vector<Result<Bytes>>> ObjectScan::read(std::span<const ObjectAddress> objects) {
  auto answers = survey_->read(objects);
  if (!answers) return answers;
  for (std::size_t i = 0; i < answers->size(); ++i) {
    silent_in_a_row_ = is_silent((*answers)[i]) ? silent_in_a_row_ + 1 : 0;
    if (silent_in_a_row_ >= kMostSilent)
      return fail(drive_error(
          Errc::timeout, node_, objects[i],
          message("no answer, as for {} reads before; it answers those of 1000h", kMostSilent - 1),
          "a drive that is silent about what it lacks cannot be scanned; --range leaves "
          "these indexes out"));
  }
  return answers;
}

Result<Result<Bytes>> ObjectScan::read_one(std::uint16_t index, unsigned sub) {
  const ObjectAddress object{index, static_cast<std::uint8_t>(sub)};
  auto answers = read(std::span(&object, 1));
  if (!answers) return fail(answers.error());
  return std::move(answers->front());
}

bool ObjectScan::is_absent(const Result<Bytes>& answer) const {
  if (answer || !answer.error().abort_code) return false;
  const auto code = *answer.error().abort_code;
  return code == abort_of::kNoObject || code == abort_of::kNoSubIndex || code == lacking_code_;
}

void ObjectScan::take(ObjectAddress object, const Result<Bytes>& answer) {
  if (!is_there(answer)) {
    state_->refusals.push_back({object, reason_of(answer.error())});
    return;
  }
  if (!answer) {
    state_->entries.push_back({object, false});
    return;
  }
  const auto begin = std::min(answer->size(), kScannedBytes);
  state_->entries.push_back({object, true, answer->size(),
                             Bytes(answer->begin(), answer->begin() + static_cast<std::ptrdiff_t>(begin))});
}

}  // namespace servoctl::session
