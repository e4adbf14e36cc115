#include "commands/pdo_use.hpp"

#include <algorithm>

#include "commands/pdo_changing.hpp"

namespace servoctl::commands {

Result<std::vector<PdoView>> read_views(show::Desk& desk, std::uint8_t node) {
  auto pdos = session::read_pdos(*desk.session, desk.profile, node);
  if (!pdos) return tl::unexpected<Error>(pdos.error());
  std::vector<PdoView> out;
  for (auto& pdo : *pdos) out.push_back(make_view(desk.profile, desk.chinese, node, std::move(pdo)));
  return out;
}

Result<const PdoView*> find_view(std::span<const PdoView> views, std::uint8_t node, std::string_view name) {
  PresentPdos present{node, {}, {}};
  for (const auto& view : views) present.pdos.push_back(view.pdo);
  const auto pdo = find_pdo(present, name);
  if (!pdo) return tl::unexpected<Error>(pdo.error());
  return &*std::find_if(views.begin(), views.end(), [&](const PdoView& view) {
    return view.pdo.direction == pdo->direction && view.pdo.number == pdo->number;
  });
}

}  // namespace servoctl::commands
