#include "pdo/pdo_use.hpp"

#include <algorithm>

#include "pdo/pdo_changing.hpp"

namespace servoctl::pdo {

Result<std::vector<show::PdoView>> read_views(show::Desk& desk, std::uint8_t node) {
  auto pdos = session::read_pdos(*desk.session, desk.profile, node);
  if (!pdos) return fail(pdos.error());
  std::vector<show::PdoView> out;
  for (auto& pdo : *pdos) out.push_back(show::make_view(desk.profile, desk.chinese, node, std::move(pdo)));
  return out;
}

Result<const show::PdoView*> find_view(std::span<const show::PdoView> views, std::uint8_t node,
                                       std::string_view name) {
  PresentPdos present{node, {}, {}};
  for (const auto& view : views) present.pdos.push_back(view.pdo);
  const auto pdo = find_pdo(present, name);
  if (!pdo) return fail(pdo.error());
  return &*std::find_if(views.begin(), views.end(), [&](const show::PdoView& view) {
    return view.pdo.direction == pdo->direction && view.pdo.number == pdo->number;
  });
}

}  // namespace servoctl::pdo
