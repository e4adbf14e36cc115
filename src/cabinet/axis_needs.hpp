#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drive/profile.hpp"
#include "session/session.hpp"
#include "session/write_plan.hpp"

namespace servoctl::cabinet {

/// What a change of an axis asks for beside the writes.
struct AxisNeed {
  /// `restart`: values hold after a restart; `standstill`: they are taken at standstill; `password`: they are
  /// behind the family's password; `state`: PDOs change outside Operational; `power`: it is energised, and
  /// nothing is written to it as long.
  enum class Kind : std::uint8_t { restart, standstill, password, state, power };
  Kind kind = Kind::restart;
  std::vector<std::string> names = {};  ///< Of the parameters that ask for it.
};
std::string_view name(AxisNeed::Kind kind);
/// Adds the name to the need of this kind, once.
void add_need(std::vector<AxisNeed>& needs, AxisNeed::Kind kind, const std::string& who);

/// `a restart (Pn0032, Pn0201)`.
std::string to_string(const AxisNeed& need);
/// `needs a restart (Pn0032, Pn0201)`.
std::string sentence(const AxisNeed& need);

/// Whether the family has a password that can be given over the bus.
bool has_password(const drive::Profile& profile);

/// What the change from `present` to `wanted`, both over the same objects, asks for: by the effects of the
/// parameters, what the family locks, and how the drive is now, which is read. Nothing where nothing differs.
Result<std::vector<AxisNeed>> needs_of(session::Session& session, const drive::Profile& profile,
                                       std::uint8_t node, const session::Values& present,
                                       const session::Values& wanted);

}  // namespace servoctl::cabinet
