#include "motion/power.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::motion {
namespace {

using drive::DriveState;

constexpr Duration kStatePause = std::chrono::milliseconds(5);
/// No way between two states has more steps; a drive that changes its state by itself could make it endless.
constexpr int kMostTransitions = 12;

}  // namespace

Error enabled_by_others(std::uint8_t node, DriveState state) {
  if (state == DriveState::fault_reaction_active || state == DriveState::quick_stop_active)
    return drive_error(Errc::refused, node, message("it is in {}", drive::name(state)),
                       "nothing was moved; `status` and `fault show` say why, `disable` de-energises it");
  return drive_error(Errc::refused, node,
                     message("it was enabled by somebody else: it is in {}", drive::name(state)),
                     "nothing was moved; `disable` it if no other master controls it");
}

Result<void> pause(session::Session& session, Duration time) {
  const auto waited = session.wait([] { return false; }, session.now() + time);
  if (!waited) return fail(waited.error());
  return {};
}

Result<std::uint16_t> Power::statusword() {
  const auto answer = session_->upload(node_, objects::kStatusword);
  if (!answer) return fail(answer.error());
  statusword_ = static_cast<std::uint16_t>(load_le(*answer));
  return statusword_;
}

Result<DriveState> Power::state() {
  const auto word = statusword();
  if (!word) return fail(word.error());
  const auto out = drive::decode_state(*word);
  auto& network = session_->network();
  if (drive::is_energised(out))
    network.end_expecting(node_);
  else if (session_->energised().contains(node_) && !network.expects_power(node_) && !says_go())
    session_->energised().erase(node_);
  return out;
}

/// Whether the drive would start again by itself, if what keeps its power away (an enable input, STO) went.
/// One that does not tell may.
bool Power::says_go() {
  constexpr std::uint64_t kCommand = 0x8F;
  constexpr std::uint64_t kEnableOperation = 0x0F;
  const auto held = session_->upload(node_, objects::kControlword);
  return !held || (load_le(*held) & kCommand) == kEnableOperation;
}

Result<void> Power::command(std::uint16_t controlword) {
  return session_->download(node_, objects::kControlword, store_le(controlword, 2));
}

bool Power::tells(std::uint16_t bit) const {
  if (bit == kRemote && !profile_->rules.remote_bit) return false;
  const auto& words = profile_->rules.statusword;
  return (words[static_cast<std::size_t>(DriveState::switched_on)] & bit) != 0;
}

std::string Power::start_command() const {
  constexpr auto kStarted = session::NodeState::operational;
  const auto now_in = session_->watch().state(node_);
  return now_in == kStarted ? std::string() : session_->network().state_command(node_, kStarted);
}

/// 605Ah decides whether a quick stop can be left upwards.
Result<bool> Power::resumes() {
  const auto& staying = profile_->rules.quick_stop_stays_enabled;
  const auto option = session_->upload(node_, objects::kQuickStopOption);
  if (!option && option.error().code != Errc::sdo_abort) return fail(option.error());
  const auto value = option ? static_cast<std::int16_t>(load_le(*option)) : std::int16_t{0};
  return std::find(staying.begin(), staying.end(), value) != staying.end();
}

Result<bool> Power::wait_for(DriveState wanted) {
  const auto end = session_->now() + kPatience;
  for (;;) {
    const auto now_in = state();
    if (!now_in) return fail(now_in.error());
    if (*now_in == wanted) return true;
    if (session_->now() >= end) return false;
    if (const auto paused = pause(*session_, kStatePause); !paused) return fail(paused.error());
  }
}

Error Power::stuck(DriveState from, const drive::PowerStep& next) const {
  const auto now_in = drive::decode_state(statusword_);
  const auto what = message("does not reach {}; it is in {} (statusword 0x{:04X})", drive::name(next.reached),
                            drive::name(now_in), statusword_);
  Message hint;
  const bool fault = now_in == DriveState::fault || now_in == DriveState::fault_reaction_active;
  if (!fault && source_)
    return drive_error(Errc::negative, node_, message("{}: {}", what, source_->cause()),
                       source_->remedy(*profile_, node_));
  if (fault)
    hint = "`fault show` shows the fault";
  else if (tells(kRemote) && (statusword_ & kRemote) == 0)
    hint = message("bit 9 (remote) is 0: {}", kRemoteCauses);
  else if (tells(kVoltageEnabled) && (statusword_ & kVoltageEnabled) == 0)
    hint = "bit 4 (voltage enabled) is 0: is the main supply on?";
  else if (from == DriveState::switch_on_disabled)
    hint = "the manual's enable conditions are not met: emergency stop, main supply, enable input?";
  else
    hint = "the manual's conditions for enabling are not met: inputs, main supply, brake, mode";
  const auto start = start_command();
  if (!start.empty() && !fault)
    hint = message("some drives obey only in the state operational: `{}`; {}", start, hint);
  return drive_error(Errc::negative, node_, what, hint);
}

Result<void> Power::step(DriveState from, const drive::PowerStep& next) {
  if (next.controlword)
    if (const auto written = command(*next.controlword); !written) return written;
  const auto end = session_->now() + kPatience;
  for (;;) {
    const auto now_in = state();
    if (!now_in) return fail(now_in.error());
    if (*now_in == next.reached) return {};
    // Some pass through a state faster than it can be read.
    if (*now_in != from && *now_in != DriveState::fault_reaction_active && *now_in != DriveState::unknown)
      return {};
    if (session_->now() >= end) return fail(stuck(from, next));
    if (const auto paused = pause(*session_, kStatePause); !paused) return paused;
  }
}

Result<std::vector<drive::PowerStep>> Power::path_to(DriveState from, DriveState goal) {
  const auto resuming = from == DriveState::quick_stop_active ? resumes() : Result<bool>(false);
  if (!resuming) return fail(resuming.error());
  if (auto path = drive::power_path(from, goal, *resuming)) return std::move(*path);
  const bool fault = from == DriveState::fault || from == DriveState::fault_reaction_active;
  return fail(drive_error(Errc::refused, node_,
                          message("is in {}: no command leads to {} from there (statusword 0x{:04X})",
                                  drive::name(from), drive::name(goal), statusword_),
                          fault ? "`fault show` shows the fault; once its cause is gone, `fault reset`"
                                : "power the drive off and on again"));
}

Result<void> Power::reach(DriveState goal) {
  for (int i = 0; i < kMostTransitions; ++i) {
    const auto from = state();
    if (!from) return fail(from.error());
    if (*from == goal) return {};
    const auto path = path_to(*from, goal);
    if (!path) return fail(path.error());
    if (const auto done = step(*from, path->front()); !done) return done;
  }
  return fail(drive_error(Errc::negative, node_,
                          message("changes state by itself and never stays in {}", drive::name(goal)),
                          "does another master control it?"));
}

Result<void> Power::disable() { return take_down(PowerAim::disable); }

Result<void> Power::quick_stop() { return take_down(PowerAim::stop); }

Result<void> Power::take_down(PowerAim aim) {
  std::vector<PowerDownPlan> plans(1);
  plans.front().node = node_;
  plans.front().aim = aim;
  const auto done = std::move(motion::take_down(*session_, std::move(plans)).front());
  statusword_ = done.statusword.value_or(statusword_);
  return done.outcome;
}

std::vector<DeEnergised> de_energise(session::Session& session, const std::set<std::uint8_t>& nodes) {
  std::vector<DeEnergised> out;
  if (nodes.empty()) return out;
  const auto hold = session.protect(session::Care::guarded);
  std::vector<PowerDownPlan> plans;
  for (const auto node : nodes) {
    plans.emplace_back();
    plans.back().node = node;
    plans.back().aim = PowerAim::stop_and_disable;
  }
  const auto done = take_down(session, plans);
  for (std::size_t i = 0; i < plans.size(); ++i)
    out.push_back({plans[i].node, done[i].outcome, done[i].outcome && done[i].state() == DriveState::fault});
  return out;
}

std::vector<DeEnergised> de_energise(session::Session& session) {
  return de_energise(session, session.energised().nodes());
}

}  // namespace servoctl::motion
