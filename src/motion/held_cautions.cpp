#include "motion/held_cautions.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/text.hpp"
#include "drive/homing_method.hpp"
#include "drive/naming.hpp"
#include "motion/control_source.hpp"
#include "show/caution_text.hpp"

namespace servoctl::motion {
namespace {

std::string condition_text(const HeldCaution& held) {
  const auto& rule = *held.rule;
  if (rule.value) return fmt::format("{} = {}", rule.name, *rule.value);
  if (rule.not_value) return fmt::format("{} is not {}", rule.name, *rule.not_value);
  return "the family's data say so";
}

/// What to do about a refusal: change the parameter, on the bus or on the panel.
std::string remedy(const HeldCaution& held, const MotionUnits& units) {
  const auto& rule = *held.rule;
  const auto ending = show::ending_setting(rule);
  if (ending.empty()) return "use another method or motion";
  const bool restart = show::needs_restart(units.profile(), rule);
  if (!held.unread && units.object(rule.name))
    return restart ? fmt::format("`{}` and restart the drive",
                                 lasting_setting(units.profile(), units.node(), rule.name, *rule.set))
                   : fmt::format("`param set {}={} -n {}` ends that", rule.name, *rule.set, units.node());
  return restart ? fmt::format("set {} on the panel and restart the drive, then add --panel {}={}", ending,
                               rule.name, *rule.set)
                 : fmt::format("set {} on the panel, then add --panel {}={}", ending, rule.name, *rule.set);
}

Error refusal(const HeldCaution& held, const MotionUnits& units, const std::string& what) {
  const auto because =
      held.unread ? fmt::format("{} cannot be read; assumed: {}", held.rule->name, condition_text(held))
                  : condition_text(held);
  return drive_error(Errc::refused, units.node(), fmt::format("{}: {}", what, because), remedy(held, units));
}

Result<void> check_method(const HeldCaution& held, const MotionUnits& units, std::int64_t method) {
  const auto& rule = *held.rule;
  if (std::find(rule.methods.begin(), rule.methods.end(), method) != rule.methods.end())
    return fail(refusal(held, units, fmt::format("homing method {} is not possible", method)));
  for (const auto input : drive::switches_of(units.profile().rules.motion, method))
    if (rule.masks_input(input))
      return fail(refusal(
          held, units,
          fmt::format("homing method {} needs {}, which the drive ignores", method, show::name(input))));
  return {};
}

}  // namespace

drive::Use Purpose::exposure() const {
  const bool stays = use == drive::Use::home && method && drive::stays_put(*method);
  return stays ? drive::Use::enable : use;
}

Result<MayHold> setting_of(session::Session& session, const MotionUnits& units, const std::string& name,
                           const OwedValues& owed) {
  const auto object = units.object(name);
  if (!object) return MayHold{std::nullopt};
  const auto answer = session.upload(units.node(), *object);
  if (!answer && answer.error().code != Errc::sdo_abort) return fail(answer.error());
  const auto number = [&](const std::optional<Bytes>& bytes) -> std::optional<double> {
    if (!bytes || bytes->empty()) return std::nullopt;
    const auto meaning = drive::fitted(units.meaning(*object), bytes->size());
    const auto value = od::decode(meaning.type, *bytes);
    if (value && meaning.type_known) return od::decode_number(meaning.encoding, *value);
    return static_cast<double>(load_le(*bytes));
  };
  MayHold out{number(answer ? std::optional(*answer) : std::nullopt)};
  const auto waiting = std::ranges::find(owed, *object, &session::OwedValue::object);
  if (waiting != owed.end()) out.push_back(number(waiting->in_force));
  return out;
}

Result<std::vector<HeldCaution>> held_cautions(session::Session& session, const MotionUnits& units,
                                               const PanelValues& panel, const OwedValues& owed,
                                               const std::function<bool(const drive::Caution&)>& concerns) {
  std::vector<HeldCaution> out;
  std::map<std::string, MayHold> known;
  for (const auto& rule : units.profile().rules.cautions) {
    if (!concerns(rule)) continue;
    if (!rule.is_conditional()) {
      out.push_back({&rule, false});
      continue;
    }
    if (known.count(rule.name) == 0) {
      auto read = setting_of(session, units, rule.name, owed);
      if (!read) return fail(read.error());
      const auto told = panel.find(rule.name);
      if (!read->front() && told != panel.end()) read->front() = static_cast<double>(told->second);
      known[rule.name] = std::move(*read);
    }
    const auto& values = known[rule.name];
    const bool true_of_one =
        std::ranges::any_of(values, [&](const auto& value) { return value && rule.holds(*value); });
    const bool unknown = std::ranges::any_of(values, [](const auto& value) { return !value; });
    if (true_of_one || unknown) out.push_back({&rule, !true_of_one});
  }
  return out;
}

Result<void> check_cautions(const std::vector<HeldCaution>& held, const MotionUnits& units,
                            const Purpose& purpose) {
  for (const auto& each : held) {
    const auto& blocked = each.rule->blocks;
    if (std::find(blocked.begin(), blocked.end(), purpose.use) != blocked.end())
      return fail(refusal(each, units, "this motion is not possible"));
    if (!purpose.method) continue;
    if (const auto possible = check_method(each, units, *purpose.method); !possible) return possible;
  }
  return {};
}

Result<PanelValues> checked_panel(const drive::Profile& profile, const PanelValues& told) {
  PanelValues out;
  for (const auto& [name, value] : told) {
    const auto parameter = drive::resolve_parameter(profile, name);
    if (!parameter) return fail(parameter.error());
    if ((*parameter)->object)
      return fail(Errc::usage, fmt::format("--panel {}: servoctl reads this parameter from the drive", name),
                  "leave it out");
    out[(*parameter)->id] = value;
  }
  return out;
}

}  // namespace servoctl::motion
