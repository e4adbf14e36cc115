#pragma once

#include <map>
#include <optional>
#include <string>

#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// A number with the unit people think in (`rpm`, `deg`, `%`), or the drive's own where nothing better is
/// known (`inc/s`).
struct Physical {
  double value = 0;
  std::string unit;
};

/// What the objects of one drive mean, with its gear and ratings, which are read once.
class MotionUnits {
 public:
  /// `turn`: increments in one turn of the motor, `encoder`: counts of its encoder, where the user tells them
  /// and the drive does not.
  MotionUnits(Session& session, const drive::Profile& profile, std::uint8_t node, std::optional<double> turn,
              std::optional<double> encoder = {});

  bool has(ObjectAddress object) const;
  drive::Meaning meaning(ObjectAddress object) const;
  /// The bytes to write for what a user wrote (`60rpm`), the nearest step there is; errors as
  /// drive::parse_quantity().
  Result<Bytes> parse(ObjectAddress object, std::string_view text) const;
  /// The number in these bytes in the unit people think in; empty when they are none.
  std::optional<Physical> physical(ObjectAddress object, ByteSpan bytes) const;
  /// What a user wrote for this object, as a number in the same unit as physical().
  Result<Physical> parse_physical(ObjectAddress object, std::string_view text) const;
  /// The bytes for a number in the unit of physical(), rounded to the nearest step and kept within the
  /// object's limits; empty when it cannot be said in this object.
  std::optional<Bytes> bytes(ObjectAddress object, double value) const;
  std::string unit(ObjectAddress object) const;

  /// The object behind a name of the family's rules (`0x6080`, `Fn_95`); empty for none.
  std::optional<ObjectAddress> object(std::string_view name) const;
  const drive::Profile& profile() const { return *profile_; }

 private:
  const drive::Profile* profile_;
  std::uint8_t node_;
  std::map<drive::Measure, double> measures_;
};

}  // namespace servoctl::session
