#include "motion/held_cautions.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/homing_method.hpp"
#include "drive/naming.hpp"
#include "motion/control_source.hpp"
#include "show/caution_text.hpp"

namespace servoctl::motion {
namespace {

std::string condition_text(const HeldCaution& held) {
  const auto& rule = *held.rule;
  if (rule.not_value && !rule.others.empty())
    return formatted("none of {}, {} is {}", rule.name, fmt::join(rule.others, ", "), *rule.not_value);
  if (rule.value) return formatted("{} = {}", rule.name, *rule.value);
  if (rule.not_value) return formatted("{} is not {}", rule.name, *rule.not_value);
  return "the family's data say so";
}

/// What to do about a refusal: change the parameter, on the bus or on the panel.
Message remedy(const HeldCaution& held, const MotionUnits& units) {
  const auto& rule = *held.rule;
  const auto ending = show::ending_setting(rule);
  if (ending.empty()) return "use another method or motion";
  const bool restart = show::needs_restart(units.profile(), rule);
  if (!rule.others.empty())
    return message("`{}` and restart the drive; any of these inputs will do",
                   lasting_setting(units.profile(), units.node(), rule.name, *rule.set));
  if (!held.unread && units.object(rule.name))
    return restart ? message("`{}` and restart the drive",
                             lasting_setting(units.profile(), units.node(), rule.name, *rule.set))
                   : message("`param set {}={} -n {}` ends that", as_it_is(rule.name), *rule.set,
                             node_name(units.node()));
  return restart
             ? message("set {} on the panel and restart the drive, then add --panel {}={}", ending,
                       as_it_is(rule.name), *rule.set)
             : message("set {} on the panel, then add --panel {}={}", ending, as_it_is(rule.name), *rule.set);
}

Error refusal(const HeldCaution& held, const MotionUnits& units, const Message& what) {
  const auto because =
      held.unread ? message("{} cannot be read; assumed: {}", as_it_is(held.rule->name), condition_text(held))
                  : Message(condition_text(held));
  return drive_error(Errc::refused, units.node(), message("{}: {}", what, because), remedy(held, units));
}

Result<void> check_method(const HeldCaution& held, const MotionUnits& units, std::int64_t method) {
  const auto& rule = *held.rule;
  if (std::find(rule.methods.begin(), rule.methods.end(), method) != rule.methods.end())
    return fail(refusal(held, units, message("homing method {} is not possible", method)));
  for (const auto input : drive::switches_of(units.profile().rules.motion, method))
    if (rule.masks_input(input))
      return fail(
          refusal(held, units,
                  message("homing method {} needs {}, which the drive ignores", method, show::name(input))));
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

namespace {

/// Whether a caution is true of the drive, and whether that is only because a parameter of it is not known.
class CautionReader {
 public:
  CautionReader(session::Session& session, const MotionUnits& units, const PanelValues& panel,
                const OwedValues& owed)
      : session_(&session), units_(&units), panel_(&panel), owed_(&owed) {}

  /// Empty where it is not true.
  Result<std::optional<HeldCaution>> read(const drive::Caution& rule) {
    HeldCaution out{&rule, false};
    if (!rule.is_conditional()) return std::optional(out);
    auto names = rule.others;
    names.insert(names.begin(), rule.name);
    for (const auto& name : names) {
      const auto values = values_of(name);
      if (!values) return fail(values.error());
      const bool true_of_one =
          std::ranges::any_of(**values, [&](const auto& value) { return value && rule.holds(*value); });
      const bool unknown = std::ranges::any_of(**values, [](const auto& value) { return !value; });
      if (!true_of_one && !unknown) return std::optional<HeldCaution>();
      out.unread = out.unread || !true_of_one;
    }
    return std::optional(out);
  }

 private:
  Result<const MayHold*> values_of(const std::string& name) {
    if (const auto found = known_.find(name); found != known_.end()) return &found->second;
    auto read = setting_of(*session_, *units_, name, *owed_);
    if (!read) return fail(read.error());
    const auto told = panel_->find(name);
    if (!read->front() && told != panel_->end()) read->front() = static_cast<double>(told->second);
    return &(known_[name] = std::move(*read));
  }

  session::Session* session_;
  const MotionUnits* units_;
  const PanelValues* panel_;
  const OwedValues* owed_;
  std::map<std::string, MayHold> known_;
};

}  // namespace

Result<std::vector<HeldCaution>> held_cautions(session::Session& session, const MotionUnits& units,
                                               const PanelValues& panel, const OwedValues& owed,
                                               const std::function<bool(const drive::Caution&)>& concerns) {
  std::vector<HeldCaution> out;
  CautionReader reader(session, units, panel, owed);
  for (const auto& rule : units.profile().rules.cautions) {
    if (!concerns(rule)) continue;
    const auto held = reader.read(rule);
    if (!held) return fail(held.error());
    if (*held) out.push_back(**held);
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
      return fail(Errc::usage, message("--panel {}: servoctl reads this parameter from the drive", name),
                  "leave it out");
    out[(*parameter)->id] = value;
  }
  return out;
}

}  // namespace servoctl::motion
