// The PDOs that a drive has.
#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "pdo/pdo_changing.hpp"

namespace servoctl::pdo {

using canopen::Pdo;

bool same_pdo(const Pdo& a, const Pdo& b) { return a.direction == b.direction && a.number == b.number; }

const Pdo* PresentPdos::find(const Pdo& like) const {
  const auto found =
      std::find_if(pdos.begin(), pdos.end(), [&](const Pdo& pdo) { return same_pdo(pdo, like); });
  return found == pdos.end() ? nullptr : &*found;
}

Result<Pdo> find_pdo(const PresentPdos& present, std::string_view name) {
  const auto like = canopen::parse_pdo_name(name);
  if (!like)
    return fail(Errc::usage, message("'{}' is not a PDO", as_it_is(name)),
                "RPDO1, TPDO2: as the drive sees them");
  if (const auto* found = present.find(*like)) return *found;
  std::string there;
  for (const auto& pdo : present.pdos) append(there, canopen::name(pdo.direction, pdo.number));
  return fail(
      Errc::usage,
      message("node {} has no {}", node_name(present.node), canopen::name(like->direction, like->number)),
      there.empty() ? "it has no PDOs that can be read" : message("it has {}", there));
}

}  // namespace servoctl::pdo
