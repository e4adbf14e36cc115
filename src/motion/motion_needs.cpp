#include "motion/motion_needs.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <string_view>
#include <vector>

#include "base/format.hpp"
#include "base/text.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "motion/operation_mode.hpp"

namespace servoctl::motion {
namespace {

struct MotionNeed {
  drive::Use use;
  std::string_view command;
  std::string_view no_mode;
  std::optional<std::int8_t> drive::MotionRules::*mode;
  ObjectAddress object;
  std::string_view object_name;  ///< As CiA 402-2 calls it: the data lack it.
};

constexpr MotionNeed kMotionNeeds[] = {
    {drive::Use::jog, "jog", "{} has no velocity mode", &drive::MotionRules::velocity,
     objects::kTargetVelocity, "Target velocity"},
    {drive::Use::move, "move", "{} has no position mode", &drive::MotionRules::position,
     objects::kTargetPosition, "Target position"},
    {drive::Use::torque, "torque", "{} has no torque mode", &drive::MotionRules::torque,
     objects::kTargetTorque, "Target torque"},
    {drive::Use::home, "home", "{} has no homing mode", &drive::MotionRules::homing, objects::kHomingMethod,
     "Homing method"},
};

const MotionNeed& need_of(drive::Use use) {
  return *std::find_if(std::begin(kMotionNeeds), std::end(kMotionNeeds),
                       [use](const MotionNeed& need) { return need.use == use; });
}

struct NamedObject {
  ObjectAddress address;
  std::string_view name;
};

/// What the data lack of it.
std::optional<NamedObject> missing(const drive::Profile& profile, const MotionNeed& need) {
  const auto has = [&](ObjectAddress object) { return profile.dictionary.find(object) != nullptr; };
  for (const auto& common :
       {NamedObject{objects::kControlword, "Controlword"}, NamedObject{objects::kStatusword, "Statusword"},
        NamedObject{objects::kModeOfOperation, "Modes of operation"}})
    if (!has(common.address)) return common;
  if (!has(need.object)) return NamedObject{need.object, need.object_name};
  if (need.use != drive::Use::move || has(objects::kPositionActual)) return std::nullopt;
  return NamedObject{objects::kPositionActual, "Position actual value"};
}

/// 6502h as a data sheet states it; 0 where it does not.
std::uint64_t modes_in_data(const drive::Profile& profile) {
  const auto* entry = profile.dictionary.find(objects::kSupportedModes);
  if (entry == nullptr || !entry->default_value || !profile.of_file) return 0;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(od::to_double(entry->default_value->value)));
}

/// Whose modes are known.
enum class ToldBy : std::uint8_t { data, drive };

Error lacks_object(const drive::Profile& profile, const MotionNeed& need, const NamedObject& object,
                   std::uint64_t modes, ToldBy told_by) {
  const auto mode = profile.rules.motion.*(need.mode);
  const auto name = to_string(object.address);
  if (mode && modes != 0 && !supports(modes, *mode))
    return make_error(
        Errc::refused,
        told_by == ToldBy::drive
            ? message("{} has no {} ({}), and 0x6502 of the drive is 0x{:X}: it has no mode {}",
                      as_it_is(profile.family), name, object.name, modes, mode_text(profile, *mode))
            : message("{} has no {} ({}), and its 0x6502 is 0x{:X}: this drive has no mode {}",
                      as_it_is(profile.family), name, object.name, modes, mode_text(profile, *mode)),
        possible_motions(profile, modes));
  auto hint = possible_motions(profile, modes);
  if (told_by == ToldBy::drive && modes != 0 && mode)
    append(hint,
           formatted("0x6502 of the drive (0x{:X}) has mode {}: the file may be incomplete; -d cia402 uses "
                     "the standard's objects",
                     modes, mode_text(profile, *mode)),
           "; ");
  return make_error(Errc::refused,
                    message("{} has no {} ({}), which `{}` needs", as_it_is(profile.family), name,
                            object.name, as_it_is(need.command)),
                    std::move(hint));
}

Result<std::int8_t> mode_by_data(const drive::Profile& profile, const MotionNeed& need, std::uint64_t modes,
                                 ToldBy told_by) {
  const auto mode = profile.rules.motion.*(need.mode);
  if (!mode)
    return fail(Errc::refused, message(fmt::runtime(need.no_mode), as_it_is(profile.family)),
                possible_motions(profile, modes));
  if (const auto object = missing(profile, need))
    return fail(lacks_object(profile, need, *object, modes, told_by));
  return *mode;
}

/// The standard's dictionary has it; whether the drive does, only the drive knows.
Result<void> check_object(session::Session& session, const drive::Profile& profile, std::uint8_t node,
                          const MotionNeed& need, std::uint64_t modes) {
  if (!profile.is_generic()) return {};
  const auto answer = session.upload(node, need.object);
  if (answer || answer.error().code != Errc::sdo_abort ||
      answer.error().abort_code != canopen::sdo_abort::kNoObject)
    return {};
  return fail(drive_error(Errc::refused, node, need.object,
                          message("has no {} ({}), which `{}` needs", to_string(need.object),
                                  need.object_name, as_it_is(need.command)),
                          possible_motions(profile, modes)));
}

}  // namespace

bool supports(std::uint64_t modes, std::int8_t mode) {
  return modes == 0 || mode < 1 || mode > 32 || (modes >> static_cast<unsigned>(mode - 1) & 1U) != 0;
}

std::string possible_motions(const drive::Profile& profile, std::uint64_t modes) {
  std::vector<std::string> commands;
  for (const auto& need : kMotionNeeds) {
    const auto mode = profile.rules.motion.*(need.mode);
    if (mode && supports(modes, *mode) && !missing(profile, need))
      commands.push_back(formatted("`{}`", need.command));
  }
  return commands.empty() ? std::string()
                          : formatted("possible with this drive: {}", fmt::join(commands, ", "));
}

Result<std::uint64_t> supported_modes(session::Session& session, const drive::Profile& profile,
                                      std::uint8_t node) {
  if (profile.dictionary.find(objects::kSupportedModes) == nullptr) return 0U;
  const auto answer = session.upload(node, objects::kSupportedModes);
  if (!answer && answer.error().code != Errc::sdo_abort) return fail(answer.error());
  return answer ? load_le(*answer) : 0U;
}

Result<std::int8_t> mode_for(const drive::Profile& profile, drive::Use use) {
  return mode_by_data(profile, need_of(use), modes_in_data(profile), ToldBy::data);
}

Result<std::int8_t> mode_for(session::Session& session, const drive::Profile& profile, std::uint8_t node,
                             drive::Use use) {
  const auto& need = need_of(use);
  const auto told = supported_modes(session, profile, node);
  if (!told) return fail(told.error());
  const auto mode = *told != 0 ? mode_by_data(profile, need, *told, ToldBy::drive) : mode_for(profile, use);
  if (!mode) return mode;
  if (const auto known = check_mode(session, profile, node, *mode); !known) return fail(known.error());
  if (const auto there = check_object(session, profile, node, need, *told); !there)
    return fail(there.error());
  return *mode;
}

}  // namespace servoctl::motion
