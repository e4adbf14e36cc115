
#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "cli/bus_holder.hpp"

namespace servoctl::cli {

Message bus_hint(std::span<const std::string> can, std::span<const std::string> coe) {
  Message ring;
  if (!coe.empty())
    ring = message("for EtherCAT drives on {}: --bus {}",
                   coe.size() == 1 ? "the Ethernet port with a link" : "an Ethernet port with a link",
                   one_of(coe));
  if (!can.empty())
    return message("add --bus {} or set SERVOCTL_BUS{}{}", one_of(can), ring.empty() ? "" : "; ", ring);
  return message(
      "this machine has no CAN interface; {}{}try `--bus sim:FAMILY@1` (`drives` lists families), or "
      "local:NAME",
      ring, ring.empty() ? "" : "; else ");
}

}  // namespace servoctl::cli
