#include "settings/stored_copies.hpp"

#include <map>
#include <utility>

#include "session/pdo_change.hpp"

namespace servoctl::settings {

std::vector<Change> changes_with(const show::Desk& desk, std::span<const Change> changes,
                                 const WriteOptions& options) {
  std::vector<Change> out(changes.begin(), changes.end());
  if (!options.keep || desk.profile == nullptr) return out;
  std::map<std::uint8_t, session::Values> wanted;
  for (const auto& change : changes) wanted[change.node].insert_or_assign(change.target.address, change.data);
  for (const auto& [node, own] : wanted) {
    auto all = own;
    session::add_stored_copies(*desk.profile, node, all);
    for (auto& [object, data] : all) {
      if (own.count(object) > 0) continue;
      const auto target = drive::target_at(desk.profile, object);
      out.push_back({node, target, target.parameter->type, std::move(data)});
    }
  }
  return out;
}

}  // namespace servoctl::settings
