#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drive/profile.hpp"
#include "session/identity.hpp"

namespace servoctl::session {

/// What the identity of a node says to the family that was named for it.
struct FamilyVerdict {
  /// `proven`: it speaks for the family. `unproven`: neither for nor against. `contradicted`: it is another.
  enum class Kind : std::uint8_t { proven, unproven, contradicted };
  Kind kind = Kind::unproven;
  std::string why;                      ///< Which object says what, and what the family says.
  std::optional<ObjectAddress> object;  ///< That contradicts.
};

/// Holds an identity against a family (or a file of the user's own) and the other families there are.
///
/// Proven: what its data states holds and is telling, or its own objects are there (Rules::identity_looks).
/// Contradicted: an object has another value than the family's data states for it; or none of its own objects
/// is there; or the family states too little, and all that tells another family apart (`telling` or
/// `certain`) holds. A file of the user's own and a family whose parent fits are not contradicted by another
/// family: they may describe the same drive.
FamilyVerdict judge_family(const Identity& identity, const drive::Profile& profile,
                           std::span<const drive::Family> families);

/// All marks of the family are there and hold.
bool fits(const Identity& identity, const drive::Rules& rules);
/// The marks hold, and its own objects are there, as far as they were looked for.
bool may_be(const Identity& identity, const drive::Rules& rules);
/// Only soft marks, which hold: a family for drives of many makers.
bool fits_as_generic(const Identity& identity, const drive::Rules& rules);
/// Some of the marks hold, and none of the others is contradicted: for an identity that lacks 1000h and
/// 1008h.
bool agrees_in_numbers(const Identity& identity, const drive::Rules& rules);
/// The family states something that other drives do not have.
bool has_marks(const drive::Rules& rules);

}  // namespace servoctl::session
