#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drive/caution.hpp"
#include "motion/motion_units.hpp"
#include "session/owed_restarts.hpp"

namespace servoctl::motion {

/// What is to be done with the motor.
struct Purpose {
  drive::Use use = drive::Use::jog;
  std::optional<std::int64_t> method = {};  ///< Of 6098h, in homing.

  /// A homing method that takes the present position as home energises the motor and moves nothing.
  drive::Use exposure() const;
};

/// What a person has read on the panel of a drive: values of parameters that have no object, by their name.
using PanelValues = std::map<std::string, std::int64_t, std::less<>>;

/// A caution of the family that is true of this drive, or may be.
struct HeldCaution {
  const drive::Caution* rule = nullptr;
  bool unread = false;  ///< Its parameter could not be read, and nobody told its value.
};

/// What a drive has stored, and goes by only after a restart.
using OwedValues = std::vector<session::OwedValue>;

/// The numbers of a parameter or object that the drive may go by, for rules of the family: what it holds, and
/// where that is `owed` the one from before as well, because a restart may have gone by unseen. Empty where
/// it has no object, the drive refuses to give it, or nobody knows what was in force.
using MayHold = std::vector<std::optional<double>>;
Result<MayHold> setting_of(session::Session& session, const MotionUnits& units, const std::string& name,
                           const OwedValues& owed);

/// The cautions of the family, of those that `concerns` selects, that are true or whose parameter cannot be
/// read. Only reads.
Result<std::vector<HeldCaution>> held_cautions(session::Session& session, const MotionUnits& units,
                                               const PanelValues& panel, const OwedValues& owed,
                                               const std::function<bool(const drive::Caution&)>& concerns);

/// Errc::refused, with the parameter to change, for the first of these that does not allow the purpose.
Result<void> check_cautions(const std::vector<HeldCaution>& held, const MotionUnits& units,
                            const Purpose& purpose);

/// Puts the names into the form of the family's data. Errc::usage for a name that is no parameter of it, and
/// for one that can be read from the drive.
Result<PanelValues> checked_panel(const drive::Profile& profile, const PanelValues& told);

}  // namespace servoctl::motion
