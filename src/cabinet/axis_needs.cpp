#include "cabinet/axis_needs.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/format.hpp"
#include "drive/cia402.hpp"
#include "drive/drive_settings.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "session/pdo_change.hpp"
#include "session/state_pause.hpp"
#include "settings/change.hpp"
#include "settings/comparison.hpp"

namespace servoctl::cabinet {
namespace {

Result<bool> is_energised(session::Session& session, std::uint8_t node) {
  const auto word = session.upload(node, objects::kStatusword);
  if (!word && word.error().code != Errc::sdo_abort) return fail(word.error());
  return word && drive::is_energised(drive::decode_state(static_cast<std::uint16_t>(load_le(*word))));
}

}  // namespace

void add_need(std::vector<AxisNeed>& needs, AxisNeed::Kind kind, const std::string& who) {
  const auto found =
      std::find_if(needs.begin(), needs.end(), [&](const AxisNeed& need) { return need.kind == kind; });
  auto& need = found != needs.end() ? *found : needs.emplace_back(AxisNeed{kind});
  if (!who.empty() && std::find(need.names.begin(), need.names.end(), who) == need.names.end())
    need.names.push_back(who);
}

std::string_view name(AxisNeed::Kind kind) {
  switch (kind) {
    case AxisNeed::Kind::restart: return "restart";
    case AxisNeed::Kind::standstill: return "standstill";
    case AxisNeed::Kind::password: return "password";
    case AxisNeed::Kind::state: return "state";
    case AxisNeed::Kind::power: return "power";
  }
  return {};
}

std::string to_string(const AxisNeed& need) {
  const auto names = need.names.empty() ? std::string() : formatted(" ({})", fmt::join(need.names, ", "));
  switch (need.kind) {
    case AxisNeed::Kind::restart: return "a restart" + names;
    case AxisNeed::Kind::standstill: return "standstill" + names;
    case AxisNeed::Kind::password: return "the password: --unlock" + names;
    case AxisNeed::Kind::state: return "Pre-operational while its PDOs change";
    case AxisNeed::Kind::power: return "to be de-energised: `disable`";
  }
  return {};
}

std::string sentence(const AxisNeed& need) {
  const auto names = need.names.empty() ? std::string() : formatted(" ({})", fmt::join(need.names, ", "));
  switch (need.kind) {
    case AxisNeed::Kind::restart: return "needs a restart" + names;
    case AxisNeed::Kind::standstill: return "needs standstill" + names;
    case AxisNeed::Kind::password: return "needs the password: --unlock" + names;
    case AxisNeed::Kind::state: return "needs Pre-operational while its PDOs change";
    case AxisNeed::Kind::power: return "needs to be de-energised: `disable`";
  }
  return {};
}

bool has_password(const drive::Profile& profile) {
  const auto& store = profile.rules.store;
  return drive::place_of(profile, store.unlock).has_value() && store.unlock_open.has_value();
}

Result<std::vector<AxisNeed>> needs_of(session::Session& session, const drive::Profile& profile,
                                       std::uint8_t node, const session::Values& present,
                                       const session::Values& wanted) {
  std::vector<AxisNeed> out;
  const auto plan = session::plan_writes(&profile, present, wanted);
  if (plan.empty()) return out;
  for (const auto& [object, data] : wanted) {
    if (present.at(object) == data) continue;
    const auto target = drive::target_at(&profile, object);
    const auto who = target.parameter != nullptr ? target.parameter->id : settings::name_of(target);
    const auto effect = drive::meaning(target, node).effect;
    // A drive that answers is where the file says: what is stored for its next start waits for none.
    const bool is_place = settings::is_address(&profile, object);
    if (effect == od::Effect::restart && !is_place) add_need(out, AxisNeed::Kind::restart, who);
    if (effect == od::Effect::standstill) add_need(out, AxisNeed::Kind::standstill, who);
    if (target.parameter != nullptr && profile.rules.store.locks(target.parameter->id))
      add_need(out, AxisNeed::Kind::password, who);
  }
  if (session::needs_pre_operational(&profile, plan)) {
    const auto state = session::ask_state(session, node);
    if (!state) return fail(state.error());
    if (*state != session::NodeState::pre_operational) add_need(out, AxisNeed::Kind::state, {});
  }
  const auto energised = is_energised(session, node);
  if (!energised) return fail(energised.error());
  if (*energised) add_need(out, AxisNeed::Kind::power, {});
  return out;
}

}  // namespace servoctl::cabinet
