#include "settings/rest.hpp"

#include <fmt/format.h>

namespace servoctl::settings {

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
