#pragma once

#include <map>
#include <optional>
#include <string>

#include "drive/load_unit.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "session/drive_units.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// A number with the unit people think in (`rpm`, `deg`, `%`), or the drive's own where nothing better is
/// known (`inc/s`).
struct Physical {
  double value = 0;
  std::string unit;
};

/// What is written to an object for what was asked, and what that is.
struct Setpoint {
  Bytes data;
  Physical value;
  std::string rounding;  ///< What was lost between two steps, when it is worth a word; else empty.
};

/// What the objects of one drive mean, with its gear and ratings, which are read once.
class MotionUnits {
 public:
  /// `turn`: increments in one turn of the motor, `encoder`: counts of its encoder, where the user tells them
  /// and the drive does not. `learned`: the number that no object tells, measured earlier
  /// (drive::Quotient::learned). `load`: what the load moves, where the user says it: its units are read, and
  /// told beside the motor's.
  MotionUnits(session::Session& session, const drive::Profile& profile, std::uint8_t node,
              std::optional<double> turn, std::optional<double> encoder = {},
              std::optional<double> learned = {}, std::optional<drive::LoadUnit> load = {});

  /// The same without a drive: what only it tells is not known.
  MotionUnits(const drive::Profile& profile, std::uint8_t node, std::optional<double> turn,
              std::optional<double> encoder, std::optional<drive::LoadUnit> load);

  /// The error of an answer about units, gear or ratings that was lost; what they are is not known then.
  const std::optional<Error>& unanswered() const { return unanswered_; }

  bool has(ObjectAddress object) const;
  drive::Meaning meaning(ObjectAddress object) const;
  /// Whether what a user wrote has a direction: of a load that runs the other way than its motor a way is
  /// turned round, and a size, such as a ramp or a limit, is not.
  enum class Kind : std::uint8_t { way, size };
  /// What to write for what a user wrote (`60rpm`); errors as drive::nearest_quantity(), and Errc::usage for
  /// a number without its unit.
  Result<Setpoint> parse(ObjectAddress object, std::string_view text, Kind kind) const;
  /// The number in these bytes in the unit people think in; empty when they are none.
  std::optional<Physical> physical(ObjectAddress object, ByteSpan bytes) const;
  /// What a user wrote about this object, as a number in the same unit as physical(); nothing is written, so
  /// nothing is rounded.
  Result<Physical> parse_physical(ObjectAddress object, std::string_view text, Kind kind) const;
  /// Whether what a user wrote can be read at all, also where only the drive tells what its unit is worth:
  /// then its sign alone is of use. `between`: it may lie between two steps of the object.
  Result<double> check(ObjectAddress object, std::string_view text, Kind kind, bool between) const;
  /// The bytes for a number in the unit of physical() that servoctl itself chose: the nearest step within the
  /// object's limits, and never zero for what is not. Empty when it cannot be said in this object.
  std::optional<Bytes> bytes(ObjectAddress object, double value) const;
  std::string unit(ObjectAddress object) const;
  /// What one of this speed object goes in a second, in the unit of 6064h; empty when their units do not fit.
  std::optional<double> rate(ObjectAddress speed) const;
  /// One count of the object in its unit; 0 for numbers of another kind, whose steps grow.
  double step(ObjectAddress object) const;
  /// Whether neither the family's data, nor the drive, nor the user tells the unit of this object: its plain
  /// numbers go to the drive as they are, and no number with a unit does.
  bool is_unproven(ObjectAddress object) const;

  /// The same in the unit of the load; empty where nobody said what it moves, or the unit is none of motion.
  std::optional<Physical> of_load(double value, std::string_view unit) const;
  /// `7200 deg`, and what the load does by it: `7200 deg (40 mm)`.
  std::string words(double value, std::string_view unit) const;

  /// Increments in one turn of the motor, by whoever told it; empty when nobody has.
  std::optional<double> turn() const;
  /// Whether they come from the number that was measured earlier.
  bool uses_learned() const { return turn_way_ != nullptr && turn_way_->learned; }
  /// How turn() was made of the drive's own objects; null where the user told it, or nobody has.
  const drive::Quotient* turn_way() const { return turn_way_; }
  /// What the drive's own objects make of turn(), where the user told another number.
  std::optional<double> other_turn() const { return other_turn_; }

  /// The object behind a name of the family's rules (`0x6080`, `Fn_95`); empty for none.
  std::optional<ObjectAddress> object(std::string_view name) const;
  const drive::Profile& profile() const { return *profile_; }
  std::uint8_t node() const { return node_; }

 private:
  /// What the user wrote of the load, as it is for the motor.
  std::string for_motor(std::string_view text, Kind kind) const;
  /// Puts in what was told beside the drive.
  void tell(std::optional<double> turn, std::optional<double> encoder);
  Error unproven(ObjectAddress object, std::string_view text) const;
  /// A number that is not 0 says its unit where the object has one: the drive's own is not what people
  /// expect, and a motor would turn by it.
  Result<void> check_unit(const drive::Meaning& what, ObjectAddress object, std::string_view text,
                          std::string_view motor) const;
  /// The error about a number, in the user's words where `motor` is not what they wrote, with what to do
  /// where nobody has told how many counts a turn has.
  Error unusable(ObjectAddress object, std::string_view text, const std::string& motor, Error error) const;

  const drive::Profile* profile_;
  std::uint8_t node_;
  std::optional<session::DriveUnits> own_;  ///< Empty without a drive.
  std::optional<Error> unanswered_;
  std::map<drive::Measure, double> measures_;
  const drive::Quotient* turn_way_ = nullptr;
  std::optional<double> other_turn_;
  std::optional<drive::LoadUnit> load_;
};

}  // namespace servoctl::motion
