#include "pdo/scope_mapping.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "pdo/pdo_changing.hpp"
#include "session/option_scope.hpp"
#include "session/pdo_change.hpp"
#include "session/pdo_setup.hpp"
#include "session/state_pause.hpp"
#include "show/pdo_check.hpp"

namespace servoctl::pdo {
namespace {

using canopen::Pdo;

/// Event-driven, by the device profile where the family knows it, else by the manufacturer.
std::uint8_t event_type(const drive::Profile& profile) {
  const auto& refused = profile.rules.pdo.refused_types;
  return std::find(refused.begin(), refused.end(), 255) == refused.end() ? 255 : 254;
}

bool is_spare(const Pdo& pdo, const session::Values& values) {
  return pdo.direction == canopen::PdoDirection::transmit && !pdo.is_valid() && pdo.event &&
         values.count({pdo.communication_index(), 1}) > 0;
}

}  // namespace

Message reason_naming(std::uint8_t node, const Error& error) {
  return error.node ? error.message : message("node {}: {}", node_name(node), error.message);
}

Result<Pdo> ScopeMapping::choose(std::span<const std::string> objects, Duration period,
                                 const std::vector<Pdo>& pdos) const {
  if (desk_->session->network().is_ring())
    return fail(Errc::negative, "--map changes TPDOs of CAN, this is EtherCAT",
                "in SAFE-OP and OP what the assigned PDOs carry is taken from process data");
  Pdo out;
  for (const auto& object : objects) {
    const auto entry = parse_mapped(*desk_->profile, object);
    if (!entry) return fail(entry.error());
    out.entries.push_back(*entry);
  }
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(period).count();
  Result<void> fits = fail(Errc::negative, "every TPDO with an event timer is in use");
  for (const auto& spare : pdos) {
    if (!is_spare(spare, before_)) continue;
    auto wanted = spare;
    wanted.entries = out.entries;
    wanted.type = event_type(*desk_->profile);
    wanted.event = static_cast<std::uint16_t>(std::clamp<std::int64_t>(ms, 1, 0xFFFF));
    if (wanted.inhibit) wanted.inhibit = 0;
    fits = show::check_mapping(*desk_->profile, wanted);
    if (fits) fits = switch_on(wanted, node_);
    auto all = pdos;
    for (auto& each : all)
      if (each.direction == wanted.direction && each.number == wanted.number) each = wanted;
    if (fits) fits = show::check_communication(*desk_->profile, spare, wanted, all);
    if (fits) return wanted;
  }
  return fail(fits.error());
}

Result<void> ScopeMapping::check_still(const std::vector<session::PlannedWrite>& plan) const {
  const bool generic = desk_->profile->is_generic();
  if (!generic && !session::needs_pre_operational(desk_->profile, plan)) return {};
  return session::check_not_energised(*desk_->session, node_);
}

Result<void> ScopeMapping::check_state(const std::vector<session::PlannedWrite>& plan) const {
  const auto state = session::ask_state(*desk_->session, node_);
  if (!state) return fail(state.error());
  if (*state != session::NodeState::operational)
    return fail(Errc::negative, "it is not known to be operational, and TPDOs are sent only then",
                message("`nmt start -n {}`", node_name(node_)));
  return check_still(plan);
}

Result<void> ScopeMapping::change(const session::Values& present, const session::Values& wanted,
                                  const session::RestoreOptions& options) {
  auto outcome = session::change_pdos(*desk_->session, desk_->profile, node_, present, wanted, options);
  for (auto& notice : outcome.notices) desk_->notices.push_back(std::move(notice));
  if (!outcome.failure) return {};
  changed_ = !outcome.rolled_back;
  return fail(*outcome.failure);
}

Result<void> ScopeMapping::begin(std::span<const std::string> objects, Duration period) {
  if (desk_->profile == nullptr) return fail(Errc::usage, "mapping needs the drive family", "-d FAMILY");
  const std::uint8_t nodes[] = {node_};
  auto read = std::move(session::read_pdo_values(*desk_->session, desk_->profile, nodes).front());
  if (!read) return fail(read.error());
  before_ = std::move(*read);
  const auto wanted = choose(objects, period, session::pdos_of(before_));
  if (!wanted) return fail(wanted.error());
  pdo_ = *wanted;
  auto present = before_;
  const auto mapped = session::values_of(*wanted, present);
  if (const auto full = session::complete(*desk_->session, node_, present, mapped); !full) return full;
  const auto plan = session::plan_writes(desk_->profile, present, mapped);
  if (const auto able = check_state(plan); !able) return able;
  if (const auto noted = record_.begin(before_, false, false); !noted) return noted;
  changed_ = true;
  const auto done = change(present, mapped, {});
  if (!done && !changed_) record_.settle();
  if (!done) end();
  return done;
}

session::Values ScopeMapping::values_before() const {
  session::Values out;
  for (const auto& [object, data] : before_)
    if (object.index == pdo_.communication_index() || object.index == pdo_.mapping_index())
      out.emplace(object, data);
  return out;
}

/// What does not hold the value from before, or does not tell.
std::string ScopeMapping::astray() const {
  std::vector<session::SdoRequest> questions;
  const auto wanted = values_before();
  for (const auto& value : wanted) questions.push_back({.node = node_, .object = value.first});
  const auto answers = desk_->session->transfer(questions);
  std::string out;
  for (std::size_t i = 0; i < answers.size(); ++i)
    if (const auto object = questions[i].object; !answers[i] || *answers[i] != wanted.at(object))
      append(out, to_string(object));
  return out;
}

/// As it is now: on many drives count 0 has cleared the entries, on others it has not.
Result<void> ScopeMapping::put_back() {
  const auto wanted = values_before();
  session::Values present;
  if (const auto read = session::complete(*desk_->session, node_, present, wanted); !read) return read;
  const auto plan = session::plan_writes(desk_->profile, present, wanted);
  if (const auto able = check_still(plan); !able) return able;
  return change(present, wanted, {.roll_back = false});
}

void ScopeMapping::end() {
  if (!std::exchange(changed_, false)) return;
  const session::Deaf deaf(*desk_->session);
  const auto done = put_back();
  changed_ = false;
  if (done) return record_.settle();
  auto error = done.error();
  error.message = message("{} could not be restored: {}; still changed, or not readable: {}",
                          canopen::name(pdo_.direction, pdo_.number), reason_naming(node_, error), astray());
  error.node = node_;
  error.hint =
      message("`pdo show -n {}` shows it; a restart of the drive loads the stored one", node_name(node_));
  desk_->errors.push_back(std::move(error));
}

}  // namespace servoctl::pdo
