#include "settings/register_writes.hpp"

#include <fmt/format.h>

#include "session/modbus_network.hpp"
#include "settings/comparison.hpp"

namespace servoctl::settings {

Result<void> check_registers(const show::Desk& desk, std::span<const Change> changes) {
  const auto* line = desk.session->modbus();
  if (line == nullptr) return {};
  for (const auto& change : changes)
    if (line->is_known(change.node) && !line->has_register(change.node, change.target.address))
      return fail(drive_error(Errc::sdo_abort, change.node, change.target.address,
                              "it has no Modbus register",
                              "nothing was written; `param list` shows what has one"));
  return {};
}

std::string_view register_reason(const show::Desk& desk, const Change& change) {
  const bool is_asked = desk.session != nullptr && desk.session->modbus() != nullptr &&
                        desk.profile != nullptr && is_line_address(*desk.profile, change.target.address);
  return is_asked ? "After a restart the drive has another Modbus address, speed or form of frames." : "";
}

void tell_not_at_rest(show::Desk& desk, std::span<const Change> changes,
                      std::span<const Result<session::Written>> written) {
  if (desk.profile == nullptr || desk.session->modbus() == nullptr) return;
  for (const auto& name : desk.profile->rules.modbus.at_rest) {
    const auto place = drive::place_of(*desk.profile, name);
    for (std::size_t i = 0; i < changes.size(); ++i)
      if (place == changes[i].target.address && load_le(changes[i].data) != 0 && written[i])
        desk.notices.push_back(fmt::format(
            "node {}: its motor may be energised and turn, and nothing stops it when servoctl or the cable is "
            "gone: `param set {}=0 -n {}`",
            changes[i].node, name, changes[i].node));
  }
}

}  // namespace servoctl::settings
