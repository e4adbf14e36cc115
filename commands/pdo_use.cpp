#include "commands/pdo_use.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/text.hpp"

namespace servoctl::commands {

Result<std::vector<PdoView>> read_views(Context& context, std::uint8_t node) {
  auto pdos = session::read_pdos(*context.session, context.profile, node);
  if (!pdos) return tl::unexpected<Error>(pdos.error());
  std::vector<PdoView> out;
  for (auto& pdo : *pdos) out.push_back(make_view(context.profile, context.chinese, node, std::move(pdo)));
  return out;
}

Result<const PdoView*> find_view(std::span<const PdoView> views, std::string_view name) {
  const auto wanted = canopen::parse_pdo_name(name);
  if (!wanted)
    return fail(Errc::usage, fmt::format("'{}' is no PDO", name),
                "write RPDO1 or TPDO2, as the drive sees it");
  const auto found = std::find_if(views.begin(), views.end(), [&](const PdoView& view) {
    return view.pdo.direction == wanted->direction && view.pdo.number == wanted->number;
  });
  if (found != views.end()) return &*found;
  std::vector<std::string> names;
  for (const auto& view : views)
    if (view.pdo.direction == wanted->direction) names.push_back(view.name);
  return fail(Errc::negative,
              fmt::format("the node has no {}", canopen::name(wanted->direction, wanted->number)),
              names.empty() ? std::string() : "it has " + one_of(names));
}

}  // namespace servoctl::commands
