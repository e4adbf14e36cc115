#include "settings/kept_address.hpp"

#include <vector>

#include "base/format.hpp"
#include "drive/naming.hpp"
#include "session/snapshot.hpp"
#include "settings/comparison.hpp"

namespace servoctl::settings {

bool tell_kept_address(show::Desk& desk, const Backup& backup, const Message& title, std::uint8_t node) {
  if (desk.profile == nullptr || desk.session->modbus() != nullptr) return false;
  const auto& profile = *desk.profile;
  const auto own_number = drive::place_of(profile, profile.rules.nmt.node_id);
  const auto wanted = side_of(backup, title.text());
  std::vector<ObjectAddress> objects;
  for (const auto& value : wanted.values)
    if (is_address(&profile, value.first) && (backup.identity.node == node || value.first != own_number))
      objects.push_back(value.first);
  const auto read = session::read_objects(*desk.session, node, objects);
  if (!read) return false;
  Side drive{formatted("node {}", node), node, {}};
  for (const auto& entry : *read)
    if (entry.bytes) drive.values.emplace(entry.object, *entry.bytes);
  bool differs = false;
  for (const auto& [object, bytes] : drive.values) {
    if (bytes == wanted.values.at(object)) continue;
    differs = true;
    const auto target = drive::target_at(desk.profile, object);
    desk.notices.push_back(
        message("node {}: {} stays {}; {} has {}, which only `restore --with-address` writes",
                node_name(node), desk.chinese ? target.label_zh() : target.label(),
                value_text(desk.profile, drive, object, desk.chinese), title,
                value_text(desk.profile, wanted, object, desk.chinese)));
  }
  return differs;
}

}  // namespace servoctl::settings
