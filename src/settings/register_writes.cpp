#include "settings/register_writes.hpp"

#include <fmt/format.h>
#include <algorithm>

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

bool is_only_echoed(const show::Desk& desk, std::span<const Change> changes) {
  return desk.session->modbus() != nullptr &&
         std::none_of(changes.begin(), changes.end(), [](const Change& change) {
           return change.target.parameter != nullptr && change.target.parameter->command;
         });
}

void tell_not_at_rest(show::Desk& desk, std::span<const Change> changes,
                      std::span<const Result<session::Written>> written) {
  if (desk.profile == nullptr || desk.session->modbus() == nullptr) return;
  const auto& rules = desk.profile->rules.modbus;
  auto names = rules.at_rest;
  names.insert(names.end(), rules.targets.begin(), rules.targets.end());
  for (const auto& name : names) {
    const auto place = drive::place_of(*desk.profile, name);
    for (std::size_t i = 0; i < changes.size(); ++i)
      if (place == changes[i].target.address && load_le(changes[i].data) != 0 &&
          session::write_end(written[i], changes[i].target.address) != session::WriteEnd::not_written)
        desk.notices.push_back(fmt::format(
            "node {}: its motor may be energised and turn, and nothing stops it when servoctl or the cable is "
            "gone: `param set {}=0 -n {}`",
            changes[i].node, name, changes[i].node));
  }
}

}  // namespace servoctl::settings
