#include "session/pdo_cob_ids.hpp"

#include <set>

#include "canopen/pdo.hpp"

namespace servoctl::session {

Result<void> add_pdo_cob_ids(Session& session, const drive::Profile& profile, std::uint8_t node,
                             const Values& before, Values& present, Values& wanted) {
  if (session.modbus() != nullptr) return {};
  std::set<ObjectAddress> missing;
  for (const auto& [object, data] : wanted) {
    const auto place = canopen::pdo_at(object.index);
    if (!place) continue;
    const ObjectAddress cob_id{canopen::Pdo{place->direction, place->number}.communication_index(), 1};
    // An interrupted restore may have left the PDO invalid although nothing else differs any more.
    const bool changes = present.at(object) != data || before.count(cob_id) > 0;
    const bool exists = profile.dictionary.find(cob_id) != nullptr;
    if (changes && exists && wanted.count(cob_id) == 0) missing.insert(cob_id);
  }
  for (const auto cob_id : missing) {
    const auto now = session.upload(node, cob_id);
    if (!now && now.error().code == Errc::sdo_abort) continue;  // It has none: nothing can be made invalid.
    if (!now) return fail(now.error());
    const auto old = before.find(cob_id);
    present.emplace(cob_id, *now);
    wanted.emplace(cob_id, old == before.end() ? *now : old->second);
  }
  return {};
}

}  // namespace servoctl::session
