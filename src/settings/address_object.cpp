#include "settings/address_object.hpp"

#include "base/format.hpp"
#include "drive/naming.hpp"

namespace servoctl::settings {

Result<drive::Profile> with_address_object(const drive::Profile& profile, std::string_view object) {
  const auto target = drive::resolve(&profile, object);
  if (!target) return fail(target.error());
  const auto& stated = profile.rules.nmt.node_id;
  if (!stated.empty() && drive::place_of(profile, stated) != target->address)
    return fail(
        Errc::refused,
        message("--object {}: {} has its node-ID in {}", as_it_is(object), as_it_is(profile.family), stated),
        "leave --object out");
  auto out = profile;
  if (stated.empty()) out.rules.nmt.node_id = to_string(target->address);
  return out;
}

Result<void> check_address_object(show::Desk& desk, const drive::Profile& profile) {
  const auto place = drive::place_of(profile, profile.rules.nmt.node_id);
  const auto node = desk.nodes.front();
  const auto held = desk.session->upload(node, *place);
  if (!held) return fail(held.error());
  if (load_le(*held) != node)
    return fail(drive_error(
        Errc::refused, node, *place,
        message("holds {}, not the node-ID {}: it may be another setting", load_le(*held), node),
        message("look into the manual; `write {} VALUE -n {}`, then `store`, write without this check",
                as_it_is(to_string(*place)), node_name(node))));
  desk.notices.push_back(message(
      "node {}: no data say when {} takes effect: after power-off and on at the latest, in some drives after "
      "`nmt reset`",
      node_name(node), to_string(*place)));
  return {};
}

}  // namespace servoctl::settings
