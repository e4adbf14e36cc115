#include "cli/heard_states.hpp"

#include <fmt/format.h>

#include "drive/cia402.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::cli {
namespace {

// The pre-defined connection set (CiA 301, table 38).
constexpr std::uint32_t kEmergencies = 0x080;
constexpr std::uint32_t kSdoAnswers = 0x580;

std::uint16_t word_at(const can::Frame& frame, std::size_t at) {
  return static_cast<std::uint16_t>(frame.data[at] | frame.data[at + 1] << 8U);
}

bool is_fault(std::uint16_t statusword) {
  const auto state = drive::decode_state(statusword);
  return state == drive::DriveState::fault || state == drive::DriveState::fault_reaction_active;
}

}  // namespace

HeardStates::HeardStates(session::Session& session)
    : session_(&session),
      hearing_(session, [this](const can::Frame& frame, TimePoint time) { on_frame(frame, time); }) {}

/// What was heard before a restart is forgotten.
HeardStates::Node& HeardStates::of_now(std::uint8_t node) {
  const auto boots = session_->watch().boots(node);
  if (nodes_[node].boots != boots) nodes_[node] = {.status = {}, .emergency = {}, .boots = boots};
  return nodes_[node];
}

void HeardStates::on_frame(const can::Frame& frame, TimePoint time) {
  if (frame.extended || frame.remote || frame.error || frame.size != 8) return;
  const auto node = static_cast<std::uint8_t>(frame.id & 0x7FU);
  const auto service = frame.id & ~0x7FU;
  if (node == 0) return;
  if (service == kSdoAnswers) on_answer(node, frame, time);
  if (service != kEmergencies) return;
  const auto code = word_at(frame, 0);
  auto& known = of_now(node);
  if (code == 0)
    known.emergency.reset();
  else
    known.emergency = Word{code, time};
}

/// An expedited upload response with the statusword (CiA 301, 7.2.4.3.6: scs 2, e 1).
void HeardStates::on_answer(std::uint8_t node, const can::Frame& frame, TimePoint time) {
  const bool expedited = (frame.data[0] & 0xE2U) == 0x42;
  const bool is_statusword = word_at(frame, 1) == objects::kStatusword.index && frame.data[3] == 0;
  if (expedited && is_statusword) of_now(node).status = Word{word_at(frame, 4), time};
}

HeardStates::State HeardStates::state(std::uint8_t node) const {
  const auto& records = session_->watch();
  const auto nmt = records.state(node);
  State out;
  if (nmt) out.text = session_->network().state_word(*nmt);
  const auto& known = nodes_[node];
  if (known.boots != records.boots(node)) return out;
  if (known.status) {
    out.text = drive::name(drive::decode_state(known.status->value));
    out.fault = is_fault(known.status->value);
    out.old = session_->now() - known.status->time > kFresh;
  }
  // A drive that says afterwards that it has no fault is believed.
  const bool newer = known.emergency && (!known.status || known.emergency->time > known.status->time);
  if (!known.emergency || !(newer || out.fault)) return out;
  out.fault = true;
  out.old = out.old && !newer;
  out.text = fmt::format("{}EMCY 0x{:04X}", newer ? "" : out.text + ", ", known.emergency->value);
  return out;
}

}  // namespace servoctl::cli
