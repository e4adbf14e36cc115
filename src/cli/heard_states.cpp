#include "cli/heard_states.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "canopen/sdo_frame.hpp"
#include "drive/cia402.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "session/can_network.hpp"
#include "session/ethercat_network.hpp"
#include "session/pdo_setup.hpp"

namespace servoctl::cli {
namespace {

// The pre-defined connection set (CiA 301, tables 38 and 39).
constexpr std::uint32_t kEmergencies = 0x080;
constexpr std::uint32_t kFirstPdo = 0x180;
constexpr std::uint32_t kLastPdo = 0x57F;
constexpr std::uint32_t kSdoAnswers = 0x580;
constexpr std::uint32_t kErrorControl = 0x700;

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
      hearing_(session, [this](const can::Frame& frame, TimePoint time) { on_frame(frame, time); }) {
  session.options().exchanged = [this, next = std::move(session.options().exchanged)](const auto& exchange) {
    on_object(exchange);
    if (next) next(exchange);
  };
}

/// What was heard before a restart is forgotten.
HeardStates::Node& HeardStates::of_now(std::uint8_t node) {
  auto& known = nodes_[node];
  if (const auto boots = session_->watch().boots(node); known.boots != boots) {
    known.boots = boots;
    known.status.reset();
    known.emergency.reset();
  }
  return known;
}

void HeardStates::on_frame(const can::Frame& frame, TimePoint time) {
  if (frame.extended || frame.remote || frame.error) return;
  if (frame.id >= kFirstPdo && frame.id <= kLastPdo) {
    tpdos_.insert_or_assign(frame.id, Payload{frame, time});
    return;
  }
  if (const auto write = canopen::sdo_write_request(frame)) return on_write(write->node, write->object, time);
  const auto node = static_cast<std::uint8_t>(frame.id & 0x7FU);
  const auto service = frame.id & ~0x7FU;
  if (node == 0) return;
  if (service == kErrorControl && frame.size == 1 && frame.data[0] == 0) nodes_[node].started = time;
  if (frame.size != 8) return;
  if (service == kSdoAnswers) on_answer(node, frame, time);
  if (service == kEmergencies) on_emergency(node, word_at(frame, 0), time);
}

/// An expedited upload response with the statusword (CiA 301, 7.2.4.3.6: scs 2, e 1).
void HeardStates::on_answer(std::uint8_t node, const can::Frame& frame, TimePoint time) {
  const bool expedited = (frame.data[0] & 0xE2U) == 0x42;
  const bool is_statusword = word_at(frame, 1) == objects::kStatusword.index && frame.data[3] == 0;
  if (expedited && is_statusword) of_now(node).status = Word{word_at(frame, 4), time};
}

void HeardStates::on_emergency(std::uint8_t node, std::uint16_t code, TimePoint time) {
  auto& known = of_now(node);
  if (code == 0)
    known.emergency.reset();
  else
    known.emergency = Word{code, time};
}

/// What this process read or wrote, on any network.
void HeardStates::on_object(const session::Exchange& exchange) {
  if (!exchange.result) return;
  const std::uint8_t node = exchange.node & 0x7FU;
  if (exchange.written != nullptr) return on_write(node, exchange.object, exchange.ended);
  const ByteSpan data(*exchange.result);
  if (data.size() < 2) return;
  const Word word{static_cast<std::uint16_t>(load_le(data.first(2))), exchange.ended};
  if (exchange.object == objects::kStatusword) of_now(node).status = word;
  if (session_->modbus() != nullptr) nodes_[node].registers.insert_or_assign(exchange.object, word);
}

void HeardStates::on_write(std::uint8_t node, ObjectAddress object, TimePoint time) {
  if (object == objects::kControlword) nodes_[node].commanded = time;
}

HeardStates::State HeardStates::state(std::uint8_t node, const Family& family) {
  const auto& records = session_->watch();
  State out;
  if (const auto nmt = records.state(node)) out.text = session_->network().state_word(*nmt);
  add_network_error(node, out);
  add_alarm(node, family, out);
  const auto& known = of_now(node);
  const auto status = newest_status(node, family);
  if (status) {
    out.text = drive::name(drive::decode_state(status->value));
    out.fault = is_fault(status->value);
    out.unsure = status->unsure || session_->now() - status->time > kFresh;
    add_network_error(node, out);
  }
  // A drive that says afterwards that it has no fault is believed.
  const bool newer = known.emergency && (!status || known.emergency->time > status->time);
  if (!known.emergency || !(newer || out.fault)) return out;
  out.fault = true;
  out.unsure = out.unsure && !newer;
  out.text = formatted("{}EMCY 0x{:04X}", newer ? "" : out.text + ", ", known.emergency->value);
  return out;
}

/// A slave that refused or left a state says so until somebody acknowledges it.
void HeardStates::add_network_error(std::uint8_t node, State& out) const {
  auto* ring = session_->ethercat();
  const auto* al = ring == nullptr ? nullptr : ring->al_of(node);
  if (al == nullptr || !al->error) return;
  out.fault = true;
  append(out.text, formatted("AL status code 0x{:04X}", al->code));
}

/// Of a value that the manual gives no alarm nobody knows what it says.
void HeardStates::add_alarm(std::uint8_t node, const Family& family, State& out) const {
  const auto& registers = nodes_[node].registers;
  const auto* profile = registers.empty() || !family ? nullptr : family();
  if (profile == nullptr || profile->rules.fault.alarm.empty()) return;
  const auto alarm = drive::resolve(profile, profile->rules.fault.alarm);
  const auto found = alarm ? registers.find(alarm->address) : registers.end();
  if (found == registers.end() || alarm->parameter == nullptr) return;
  const auto& word = found->second;
  const auto& known = alarm->parameter->labels;
  if (std::none_of(known.begin(), known.end(), [&](const auto& one) { return one.value == word.value; }))
    return;
  out.text = formatted("alarm 0x{:04X}", word.value);
  out.fault = true;
  out.unsure = session_->now() - word.time > kFresh;
}

/// A guess that says the same as what is sure leaves that sure.
std::optional<HeardStates::Word> HeardStates::newest_status(std::uint8_t node, const Family& family) {
  const auto& known = nodes_[node];
  auto out = known.status;
  if (out && out->time <= known.commanded) out->unsure = true;
  for (const auto& other : {status_in_image(node), status_in_tpdos(node, family)}) {
    if (!other || (out && other->time < out->time)) continue;
    const bool same = out && drive::decode_state(out->value) == drive::decode_state(other->value);
    const bool is_known = out && !out->unsure && session_->now() - out->time <= kFresh;
    if (!other->unsure || !same || !is_known) out = other;
  }
  return out;
}

std::optional<HeardStates::Word> HeardStates::status_in_image(std::uint8_t node) const {
  auto* ring = session_->ethercat();
  const auto* image = ring == nullptr ? nullptr : ring->image_of(node);
  const auto input = image == nullptr ? std::nullopt : image->input(node, objects::kStatusword);
  if (!input || input->value.size() != 2) return std::nullopt;
  return Word{static_cast<std::uint16_t>(load_le(input->value)), input->time};
}

std::optional<HeardStates::Word> HeardStates::status_in_tpdos(std::uint8_t node, const Family& family) {
  auto* can = session_->can();
  if (can == nullptr || tpdos_.empty()) return std::nullopt;
  auto& of_node = nodes_[node];
  auto& out = of_node.in_tpdos;
  if (const auto* known = can->known_pdos(node)) {
    out = status_in(known->pdos);
    // What came before it was read may have been mapped otherwise.
    if (out && out->time < known->time) out->unsure = true;
  } else if (can->mapping_was_changed(node)) {
    if (out) out->unsure = true;  // What came since means something else.
  } else if (const auto* profile = family ? family() : nullptr) {
    if (std::exchange(of_node.family, profile) != profile)
      of_node.assumed = session::pdos_of(session::default_pdo_values(*profile, node));
    out = status_in(of_node.assumed);
    if (out) out->unsure = true;
  }
  return out && out->time < of_node.started ? std::nullopt : out;
}

/// The statusword of the last frame that carried it whole.
std::optional<HeardStates::Word> HeardStates::status_in(std::span<const canopen::Pdo> pdos) const {
  std::optional<Word> out;
  for (const auto& pdo : pdos) {
    const bool sends = pdo.direction == canopen::PdoDirection::transmit && pdo.is_valid();
    const auto found = sends ? tpdos_.find(pdo.can_id()) : tpdos_.end();
    // Another length is another mapping.
    if (found == tpdos_.end() || found->second.frame.size != (pdo.bits() + 7) / 8) continue;
    const auto parts = canopen::unpack_pdo(pdo.entries, found->second.frame.payload());
    for (std::size_t i = 0; parts && i < parts->size(); ++i) {
      const bool whole = pdo.entries[i].object == objects::kStatusword && pdo.entries[i].bits == 16;
      if (whole && (!out || out->time < found->second.time))
        out = Word{static_cast<std::uint16_t>(load_le((*parts)[i])), found->second.time};
    }
  }
  return out;
}

}  // namespace servoctl::cli
