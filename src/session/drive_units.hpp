#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drive/profile.hpp"
#include "drive/quantity.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// The units of position, speed and acceleration of one drive, where the data of its family only assume them
/// (drive::is_unit_assumed), by its own objects: 60A8h, 60A9h and 60AAh (CiA 402-2), 6096h.
class DriveUnits {
 public:
  struct Unit {
    std::string name;
    double scale = 1;  ///< One of the raw value in it.
  };

  /// Of a drive that cannot be asked: it names none.
  DriveUnits() = default;
  /// Asks the drive for those of these objects that its dictionary has. Of a family whose data state the
  /// units nothing is read.
  DriveUnits(Session& session, const drive::Profile& profile, std::uint8_t node);

  /// Somebody knows how many increments a turn has: positions are increments then.
  void prove_position();
  /// Puts the unit of the drive in the place of an assumed one, and takes that away where the drive names
  /// none. Meaning::unit then points into this.
  void apply(const drive::Target& target, drive::Meaning& meaning) const;
  /// Whether the unit of such an object is known; true for one that nobody assumed.
  bool proves(const drive::Target& target) const;
  /// The error of an answer that was lost: what the drive says is not known.
  const std::optional<Error>& unanswered() const { return unanswered_; }

 private:
  const std::optional<Unit>& of(const drive::Target& target) const;

  std::optional<Unit> position_;
  std::optional<Unit> velocity_;
  std::optional<Unit> acceleration_;
  std::optional<Error> unanswered_;
};

}  // namespace servoctl::session
