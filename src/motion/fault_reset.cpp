#include "motion/fault_reset.hpp"

#include "base/format.hpp"
#include "drive/cia402.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "motion/power.hpp"
#include "session/option_scope.hpp"
#include "session/setting_write.hpp"

namespace servoctl::motion {
namespace {

using drive::DriveState;

constexpr std::uint16_t kResetEdge = 0x0080;
/// How long a drive may take for the transition; manuals name none.
constexpr Duration kResetPatience = std::chrono::milliseconds(500);
constexpr Duration kResetPause = std::chrono::milliseconds(20);

Result<DriveState> read_state(session::Session& session, std::uint8_t node) {
  const auto answer = session.upload(node, objects::kStatusword);
  if (!answer) return fail(answer.error());
  return drive::decode_state(static_cast<std::uint16_t>(load_le(*answer)));
}

/// Whether the drive is out of "fault" before the time is over.
Result<bool> left_fault(session::Session& session, std::uint8_t node) {
  const auto end = session.now() + kResetPatience;
  for (;;) {
    const auto state = read_state(session, node);
    if (!state) return fail(state.error());
    if (*state != DriveState::fault && *state != DriveState::fault_reaction_active) return true;
    if (session.now() >= end) return false;
    if (const auto waited = session.wait([] { return false; }, session.now() + kResetPause); !waited)
      return fail(waited.error());
  }
}

/// Writes the edge and takes it back, whatever becomes of it: while bit 7 stays set the drive obeys no other
/// command, so neither Ctrl-C nor a lost answer may come between the two.
Result<bool> by_controlword(session::Session& session, std::uint8_t node) {
  const auto prepared = session.download(node, objects::kControlword, store_le(0, 2));
  if (!prepared) return fail(prepared.error());
  const session::Deaf deaf(session);
  const auto edge = session.download(node, objects::kControlword, store_le(kResetEdge, 2));
  const auto left = edge ? left_fault(session, node) : fail(edge.error());
  const auto released = session.download(node, objects::kControlword, store_le(0, 2));
  if (left && released) return left;
  auto error = left ? released.error() : left.error();
  if (!released)
    error.hint =
        "controlword bit 7 may still be set; if so, the drive obeys no other command: `write 0x6040 0` "
        "clears it";
  return fail(std::move(error));
}

Result<bool> by_settings(session::Session& session, const drive::Profile& profile, std::uint8_t node) {
  for (const auto& setting : profile.rules.fault.reset) {
    const auto write = session::setting_write(profile, node, setting);
    if (!write) return fail(write.error());
    if (const auto written = session.download(node, write->object, *write->data); !written)
      return fail(written.error());
    const auto left = left_fault(session, node);
    if (!left || *left) return left;
  }
  return false;
}

/// A drive without fault must be without power as well: another master may hold an enabling controlword.
Result<FaultReset> check_power(session::Session& session, std::uint8_t node) {
  const auto state = read_state(session, node);
  if (!state) return fail(state.error());
  if (!drive::is_energised(*state)) return FaultReset::done;
  return fail(
      drive_error(Errc::negative, node,
                  message("its fault is reset, but it is energised: it is in {}", drive::name(*state)),
                  "another master controls it; stop and disable it, or switch off its supply"));
}

/// Errc::refused for a drive that has its power and no fault.
Result<bool> needs_reset(session::Session& session, std::uint8_t node) {
  const auto state = read_state(session, node);
  if (!state) return fail(state.error());
  if (*state == DriveState::fault || *state == DriveState::fault_reaction_active) return true;
  if (!drive::is_energised(*state)) return false;
  return fail(
      drive_error(Errc::refused, node,
                  message("it is in {}, not in Fault: a reset would de-energise it", drive::name(*state)),
                  "stop and disable it first"));
}

bool resets_by_controlword(const drive::Profile* profile) {
  return profile == nullptr || profile->rules.fault.by_controlword;
}

}  // namespace

Result<std::vector<session::PlannedMessage>> plan_fault_reset(session::Session& session,
                                                              const drive::Profile* profile,
                                                              std::uint8_t node) {
  const auto needed = needs_reset(session, node);
  if (!needed) return fail(needed.error());
  std::vector<session::PlannedMessage> out;
  if (!*needed) return out;
  if (resets_by_controlword(profile))
    for (const std::uint16_t word : {std::uint16_t{0}, kResetEdge, std::uint16_t{0}})
      out.push_back(session::planned_write({node, objects::kControlword, store_le(word, 2)}));
  if (profile == nullptr) return out;
  for (const auto& setting : profile->rules.fault.reset) {
    const auto write = session::setting_write(*profile, node, setting);
    if (!write) return fail(write.error());
    out.push_back(session::planned_write(*write, out.empty() ? "" : "if the fault remains"));
  }
  return out;
}

Result<FaultReset> reset_fault(session::Session& session, const drive::Profile* profile, std::uint8_t node) {
  const auto needed = needs_reset(session, node);
  if (!needed) return fail(needed.error());
  if (!*needed) return FaultReset::no_fault;
  Result<bool> left = false;
  if (resets_by_controlword(profile)) left = by_controlword(session, node);
  if (left && !*left && profile != nullptr) left = by_settings(session, *profile, node);
  if (!left) return fail(left.error());
  if (*left) return check_power(session, node);
  auto error = drive_error(Errc::negative, node, "the fault remains",
                           "remove its cause (`fault show`); some faults need a power cycle");
  const auto* gate = profile != nullptr && profile->rules.fault.reset_enabled_by
                         ? &*profile->rules.fault.reset_enabled_by
                         : nullptr;
  if (gate != nullptr)
    error.hint += message("; this family resets faults only where {} is {}",
                          drive::target_at(profile, gate->object).in_sentence(), gate->value);
  return fail(std::move(error));
}

}  // namespace servoctl::motion
