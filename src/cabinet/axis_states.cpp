#include "cabinet/axis_states.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>

#include "drive/standard_mode.hpp"
#include "drive/standard_objects.hpp"
#include "motion/kept_turn.hpp"
#include "session/answer.hpp"
#include "session/ethercat_network.hpp"
#include "session/option_scope.hpp"
#include "session/ring_state.hpp"
#include "session/state_pause.hpp"
#include "session/wary.hpp"
#include "show/axis_names.hpp"
#include "show/fault_records.hpp"
#include "show/ring_table.hpp"

namespace servoctl::cabinet {
namespace {

constexpr std::array kObjects{objects::kStatusword, objects::kModeDisplay, objects::kErrorCode,
                              objects::kPositionActual};

std::string network_of(session::Session& session, std::uint8_t node) {
  if (const auto* ring = session.ethercat()) {
    const auto* al = ring->al_of(node);
    return al == nullptr ? std::string() : show::al_text(*al);
  }
  const auto nmt = session.watch().state(node);
  return nmt ? std::string(session::name(*nmt)) : std::string();
}

/// As people of the cabinet call it.
Error named(const Axis& axis, Error error) {
  const show::AxisNames names({{axis.node, axis.name}});
  names.put_into(error.message);
  names.put_into(error.hint);
  return error;
}

}  // namespace

const AxisStates::Known& AxisStates::known(const Axis& axis, session::Session& session) {
  auto& out = known_[&axis];
  if (out.profile != nullptr) return out;
  const auto profile = load_(axis.family);
  if (!profile) return out;
  out.profile = *profile;
  show::Desk desk;
  desk.session = &session;
  desk.profile = *profile;
  desk.state_folder = desk_->state_folder;
  const auto as_number = [](const std::optional<std::uint64_t>& counts) {
    return counts ? std::optional(static_cast<double>(*counts)) : std::nullopt;
  };
  const auto learned = axis.turn ? std::nullopt : motion::find_turn(desk, axis.node).counts;
  out.units = std::make_unique<motion::MotionUnits>(session, **profile, axis.node, as_number(axis.turn),
                                                    as_number(axis.encoder), learned, axis.load);
  return out;
}

void AxisStates::take(AxisState& look, session::Session& session, std::span<const Result<Bytes>> answers) {
  const auto& word = answers[0];
  if (!word) {
    look.error = named(*look.axis, word.error());
    return;
  }
  look.network = network_of(session, look.axis->node);
  look.state = drive::decode_state(static_cast<std::uint16_t>(load_le(*word)));
  const auto& known = this->known(*look.axis, session);
  if (const auto mode = session::number_in(answers[1])) {
    look.mode = static_cast<std::int8_t>(*mode);
    look.mode_word = drive::mode_word(known.profile, *look.mode, desk_->chinese);
  }
  if (const auto code = session::number_in(answers[2])) look.fault = static_cast<std::uint16_t>(*code);
  look.told_fault =
      show::told_fault(known.profile, desk_->chinese, look.fault, static_cast<std::uint16_t>(load_le(*word)));
  if (!answers[3] || known.units == nullptr) return;
  look.position = known.units->physical(objects::kPositionActual, *answers[3]);
  if (!look.position) return;
  if (const auto load = known.units->of_load(look.position->value, look.position->unit)) look.position = load;
}

void AxisStates::look_on(const Bus& bus, std::vector<AxisState>& out) {
  std::vector<AxisState*> mine;
  for (auto& look : out)
    if (look.axis->bus == bus.name) mine.push_back(&look);
  if (mine.empty()) return;
  const auto opened = open_(bus);
  if (!opened) {
    for (auto* look : mine) look->error = opened.error();
    return;
  }
  auto& session = **opened;
  // Another drive may be there than the one that the file names.
  const session::OptionScope checked(session, &session::Options::checks_numbers, true);
  std::vector<session::SdoRequest> requests;
  for (const auto* look : mine) {
    if (const auto profile = load_(look->axis->family)) {
      if (auto* ring = session.ethercat()) ring->learn(look->axis->node, (*profile)->rules.coe);
      session::be_wary_of_family(session, look->axis->node, **profile);
    }
    for (const auto object : kObjects) requests.push_back({look->axis->node, object});
  }
  const auto answers = session.transfer(requests);
  for (std::size_t i = 0; i < mine.size(); ++i) {
    const auto of_node = std::span(answers).subspan(i * kObjects.size(), kObjects.size());
    if (session.network().tells_state() && of_node[0]) (void)session::ask_state(session, mine[i]->axis->node);
    take(*mine[i], session, of_node);
  }
}

std::vector<AxisState> AxisStates::look() {
  std::vector<AxisState> out;
  for (const auto* axis : axes_) out.emplace_back().axis = axis;
  for (const auto& bus : cabinet_->buses) look_on(bus, out);
  return out;
}

}  // namespace servoctl::cabinet
