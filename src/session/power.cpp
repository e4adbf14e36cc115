#include "session/power.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cstdlib>

#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "session/deaf.hpp"

namespace servoctl::session {
namespace {

using drive::DriveState;

constexpr std::uint16_t kQuickStop = 0x0002;
constexpr std::uint16_t kDisableVoltage = 0x0000;
constexpr Duration kPause = std::chrono::milliseconds(5);
/// No way between two states has more steps; a drive that changes its state by itself could make it endless.
constexpr int kMostSteps = 12;
/// A motor at rest shows some noise: this part of its greatest speed.
constexpr std::uint64_t kStandstillPart = 50;

}  // namespace

Error drive_error(Errc code, std::uint8_t node, const std::string& what, std::string hint) {
  Error error;
  error.code = code;
  error.message = fmt::format("node {}: {}", node, what);
  error.hint = std::move(hint);
  error.node = node;
  return error;
}

Error enabled_by_others(std::uint8_t node, DriveState state) {
  return drive_error(Errc::refused, node,
                     fmt::format("somebody else has enabled it: it is in {}", drive::name(state)),
                     "nothing was moved; `disable` it when no other master commands it");
}

Result<void> pause(Session& session, Duration time) {
  const auto waited = session.wait([] { return false; }, session.now() + time);
  if (!waited) return tl::unexpected<Error>(waited.error());
  return {};
}

Result<std::uint16_t> Power::statusword() {
  const auto answer = session_->upload(node_, objects::kStatusword);
  if (!answer) return tl::unexpected<Error>(answer.error());
  statusword_ = static_cast<std::uint16_t>(load_le(*answer));
  return statusword_;
}

Result<DriveState> Power::state() {
  const auto word = statusword();
  if (!word) return tl::unexpected<Error>(word.error());
  const auto out = drive::decode_state(*word);
  if (!drive::is_energised(out)) session_->energised().erase(node_);
  return out;
}

Result<void> Power::command(std::uint16_t controlword) {
  return session_->download(node_, objects::kControlword, store_le(controlword, 2));
}

bool Power::tells(std::uint16_t bit) const {
  const auto& words = profile_->rules.statusword;
  return (words[static_cast<std::size_t>(DriveState::switched_on)] & bit) != 0;
}

/// 605Ah decides whether a quick stop can be left upwards.
bool Power::resumes() {
  const auto& staying = profile_->rules.quick_stop_stays_enabled;
  const auto option = session_->upload(node_, objects::kQuickStopOption);
  const auto value = option ? static_cast<std::int16_t>(load_le(*option)) : std::int16_t{0};
  return std::find(staying.begin(), staying.end(), value) != staying.end();
}

Result<bool> Power::wait_for(DriveState wanted) {
  const auto end = session_->now() + kPatience;
  for (;;) {
    const auto now_in = state();
    if (!now_in) return tl::unexpected<Error>(now_in.error());
    if (*now_in == wanted) return true;
    if (session_->now() >= end) return false;
    if (const auto paused = pause(*session_, kPause); !paused) return tl::unexpected<Error>(paused.error());
  }
}

Error Power::stuck(DriveState from, const drive::PowerStep& next) const {
  const auto now_in = drive::decode_state(statusword_);
  auto what = fmt::format("does not go to {}; it is in {} (statusword 0x{:04X})", drive::name(next.reached),
                          drive::name(now_in), statusword_);
  std::string hint;
  if (now_in == DriveState::fault || now_in == DriveState::fault_reaction_active)
    hint = "`fault show` tells the fault";
  else if (tells(kRemote) && (statusword_ & kRemote) == 0)
    hint = "bit 9 (remote) is low: the drive obeys its panel or inputs, not the bus";
  else if (tells(kVoltageEnabled) && (statusword_ & kVoltageEnabled) == 0)
    hint = "bit 4 (voltage enabled) is low: is the main supply on?";
  else if (from == DriveState::switch_on_disabled)
    hint = "emergency stop, main supply, enable input? The manual's enable conditions are not met";
  else
    hint = "the manual's conditions for enabling are not met: inputs, main supply, brake, mode";
  return drive_error(Errc::negative, node_, what, hint);
}

Result<void> Power::step(DriveState from, const drive::PowerStep& next) {
  if (next.controlword)
    if (const auto written = command(*next.controlword); !written) return written;
  const auto end = session_->now() + kPatience;
  for (;;) {
    const auto now_in = state();
    if (!now_in) return tl::unexpected<Error>(now_in.error());
    if (*now_in == next.reached) return {};
    // Some pass through a state faster than it can be read.
    if (*now_in != from && *now_in != DriveState::fault_reaction_active && *now_in != DriveState::unknown)
      return {};
    if (session_->now() >= end) return fail(stuck(from, next));
    if (const auto paused = pause(*session_, kPause); !paused) return paused;
  }
}

Result<void> Power::reach(DriveState goal) {
  for (int i = 0; i < kMostSteps; ++i) {
    const auto from = state();
    if (!from) return tl::unexpected<Error>(from.error());
    if (*from == goal) return {};
    const bool resuming = *from == DriveState::quick_stop_active && resumes();
    const auto path = drive::power_path(*from, goal, resuming);
    if (!path) {
      const bool fault = *from == DriveState::fault || *from == DriveState::fault_reaction_active;
      return fail(drive_error(Errc::refused, node_,
                              fmt::format("is in {}: no command leads from there to {} (statusword 0x{:04X})",
                                          drive::name(*from), drive::name(goal), statusword_),
                              fault ? "`fault show` tells the fault; when its cause is gone, `fault reset`"
                                    : "power the drive off and on again"));
    }
    if (const auto done = step(*from, path->front()); !done) return done;
  }
  return fail(drive_error(Errc::negative, node_,
                          fmt::format("changes its state by itself and never stays in {}", drive::name(goal)),
                          "does another master command it?"));
}

Result<void> Power::disable() {
  const Deaf deaf(*session_);
  const auto is_in_fault = [](DriveState state) {
    return state == DriveState::fault || state == DriveState::fault_reaction_active;
  };
  const auto before = state();
  if (before && !drive::is_energised(*before) && is_in_fault(*before)) return {};
  if (before && *before == DriveState::operation_enabled) (void)reach(DriveState::switched_on);
  if (const auto off = command(kDisableVoltage); !off) return off;
  const auto reached = state();
  if (!reached) return tl::unexpected<Error>(reached.error());
  if (*reached == DriveState::fault) return {};
  if (*reached != DriveState::fault_reaction_active) return reach(DriveState::switch_on_disabled);
  const auto ended = wait_for(DriveState::fault);
  if (!ended) return tl::unexpected<Error>(ended.error());
  if (*ended) return {};
  return fail(drive_error(Errc::negative, node_, "still brakes after a fault, and may have its power",
                          "`status` shows its state"));
}

/// By its speed, whatever unit that has; without one by bit 10 (CiA 402-2: a quick stop has ended at
/// standstill).
bool Power::has_stopped(std::optional<std::uint64_t>& fastest) {
  const auto answer = session_->upload(node_, objects::kVelocityActual);
  if (!answer || answer->size() > 4 || answer->empty()) return (statusword_ & kTargetReached) != 0;
  const auto bits = 64 - 8 * static_cast<int>(answer->size());
  const auto speed = static_cast<std::int64_t>(load_le(*answer) << bits) >> bits;
  const auto size = static_cast<std::uint64_t>(std::abs(speed));
  fastest = std::max(fastest.value_or(size), size);
  return size <= *fastest / kStandstillPart;
}

Result<void> Power::quick_stop() {
  const Deaf deaf(*session_);
  const auto before = state();
  if (!before) return tl::unexpected<Error>(before.error());
  if (!drive::is_energised(*before)) return {};
  std::optional<std::uint64_t> fastest;
  (void)has_stopped(fastest);
  if (const auto told = command(kQuickStop); !told) return told;
  const auto end = session_->now() + kQuickStopPatience;
  std::optional<TimePoint> standing_since;
  for (;;) {
    const auto now_in = state();
    if (!now_in) return tl::unexpected<Error>(now_in.error());
    if (!drive::is_energised(*now_in)) return {};
    const bool followed = *now_in == DriveState::quick_stop_active;
    if (!followed || !has_stopped(fastest))
      standing_since.reset();
    else if (!standing_since)
      standing_since = session_->now();
    // Most lose their power then by themselves; by 605Ah some stay.
    if (standing_since && session_->now() - *standing_since >= kPatience) return {};
    if (session_->now() >= end)
      return fail(drive_error(
          Errc::negative, node_,
          followed ? std::string("is in quick stop active and does not tell that it stands still")
                   : fmt::format("does not follow the quick stop; it is in {} (statusword 0x{:04X})",
                                 drive::name(*now_in), statusword_),
          followed ? "look at the motor; `disable` takes its power away"
                   : "does another master command it? `disable`, or take the power away"));
    if (const auto paused = pause(*session_, kPause); !paused) return paused;
  }
}

std::vector<std::pair<std::uint8_t, Result<void>>> de_energise(Session& session) {
  std::vector<std::pair<std::uint8_t, Result<void>>> out;
  if (session.energised().empty()) return out;
  const Deaf deaf(session);
  const auto& protect = session.options().protect;
  if (protect) protect(true);
  const drive::Profile plain;
  for (const auto node : std::set(session.energised())) {
    Power power(session, plain, node);
    // It may have been disabled by others meanwhile.
    if (const auto state = power.state(); state && !drive::is_energised(*state)) continue;
    (void)power.quick_stop();
    out.emplace_back(node, power.disable());
  }
  if (protect) protect(false);
  return out;
}

}  // namespace servoctl::session
