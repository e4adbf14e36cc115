#include "motion/lost_master.hpp"

namespace servoctl::motion {

std::string_view text_of(Stops stops) {
  switch (stops) {
    case Stops::yes: return "yes";
    case Stops::unknown: return "not known";
    case Stops::no: break;
  }
  return "no";
}

Stops LostMaster::stops() const {
  if (!noticed) return alarms ? Stops::unknown : Stops::no;
  if (option == 0) return Stops::no;
  constexpr std::int64_t kLastStandard = 3;  // CiA 402-2, 6007h: fault, disable voltage, quick stop.
  const bool reacts = option && *option > 0 && *option <= kLastStandard;
  const bool faults =
      fault && !option;  // A reaction of the maker's own may come with the fault, and be none.
  return (reacts || power_off || faults) && !assumed ? Stops::yes : Stops::unknown;
}

std::string lost_master_fault(const drive::Profile& profile) {
  constexpr std::uint16_t kLifeGuardError = 0x8130;
  if (profile.is_generic()) return {};
  for (const auto& fault : profile.faults)
    if (fault.code == kLifeGuardError && fault.kind == drive::Fault::Kind::fault) return fault.name;
  return {};
}

bool leaves_operational(std::uint8_t behaviour) { return behaviour == 0 || behaviour == 2; }

}  // namespace servoctl::motion
