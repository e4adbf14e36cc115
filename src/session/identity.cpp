#include "session/identity.hpp"

namespace servoctl::session {

std::string different_number(const Identity& before, const Identity& now) {
  if (before.device_type != now.device_type) return "its device type (1000h)";
  if (before.vendor_id != now.vendor_id) return "its vendor (1018h:01)";
  if (before.product_code != now.product_code) return "its product code (1018h:02)";
  if (before.revision != now.revision) return "its revision (1018h:03)";
  return before.serial != now.serial ? "its serial number (1018h:04)" : std::string();
}

}  // namespace servoctl::session
