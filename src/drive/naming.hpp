#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/object_address.hpp"
#include "base/result.hpp"
#include "drive/profile.hpp"

namespace servoctl::drive {

/// What a name on the command line stands for. Entry and parameter point into the profile; each may be
/// missing: an address needs no dictionary, a panel parameter may have no object.
struct Target {
  ObjectAddress address;
  const od::Entry* entry = nullptr;
  const od::Parameter* parameter = nullptr;
  std::string unlisted;    ///< A panel number the family's rule gives an object, but its table does not list.
  bool read_only = false;  ///< By the rule of such numbers.

  /// `Pn0202 Auto tuning mode`, `Statusword`, or empty when nothing is known.
  std::string label() const;
  std::string label_zh() const;
  /// How a sentence names it: `Pn0202 Auto tuning mode`, `0x6041:0 Statusword`, or the address alone.
  std::string in_sentence() const;
  std::string in_sentence_zh() const;
  /// The manual states more than one value of a field of the parameter (`scale`), see od::Parameter::doubts.
  bool is_contradicted(std::string_view field) const;
};

/// How much of a name has to be written: all of it, or, where nothing is changed, a part that no other name
/// has (`loop gain`).
enum class Match : std::uint8_t { whole, part };

/// Finds an object by address (`0x6041`, `6099h.1`), by name as the maker wrote it (`statusword`,
/// `homing_speeds.switch`, `Pr1.01 1st velocity loop gain`, `速度环增益1`, `状态字`) or by panel number
/// (`Pn202`), in any case. Without a profile only addresses are understood. Errc::usage when the name is
/// unknown (nearest names offered), ambiguous (all meanings offered), or belongs to a parameter without an
/// object.
Result<Target> resolve(const Profile* profile, std::string_view text, Match match = Match::whole);

/// The panel parameter of this number or name. Errc::usage as in resolve(); one without an object is found as
/// well.
Result<const od::Parameter*> resolve_parameter(const Profile& profile, std::string_view text,
                                               Match match = Match::whole);

/// The object of a panel parameter, by number or name; of numbers the table does not list as well where the
/// family's rule allows it. Errc::usage as in resolve().
Result<Target> resolve_panel(const Profile& profile, std::string_view text, Match match = Match::whole);

/// Where a parameter or object stands that the rules name (`Pn0049`, `0x2003:01`); empty for an empty name
/// and for a parameter without an object.
std::optional<ObjectAddress> place_of(const Profile& profile, std::string_view name);

/// All names that resolve() understands, for completion: panel numbers as printed, then objects in index
/// order.
std::vector<std::string> names(const Profile& profile);

/// The name of one entry in the form resolve() reads: `statusword`,
/// `homing_speeds.speed_during_search_for_switch`.
std::string entry_name(const od::Object& object, const od::Entry& entry);

/// The target at this address, with whatever the profile (may be null) knows of it.
Target target_at(const Profile* profile, ObjectAddress address);

}  // namespace servoctl::drive
