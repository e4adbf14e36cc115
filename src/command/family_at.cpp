#include "command/family_at.hpp"

#include "base/format.hpp"
#include "session/open_bus.hpp"

namespace servoctl::command {
namespace {

/// What the cabinet file has there; null: nothing.
const cabinet::Axis* axis_on_line(const Context& context, const cabinet::Cabinet& cabinet,
                                  std::uint8_t node) {
  const auto url = session::canonical_url(context.session->url());
  for (const auto& axis : cabinet.axes) {
    const auto* bus = cabinet.bus(axis.bus);
    if (axis.node == node && bus != nullptr && session::canonical_url(bus->url) == url) return &axis;
  }
  return nullptr;
}

}  // namespace

Result<const drive::Profile*> family_at(const Context& context, const std::string& named, std::uint8_t node) {
  if (!named.empty()) return context.front_end->family(named);
  if (context.profile != nullptr) return context.profile;
  const auto cabinet = context.front_end->cabinet();
  if (!cabinet && cabinet.error().code != Errc::usage) return fail(cabinet.error());
  if (const auto* axis = cabinet ? axis_on_line(context, **cabinet, node) : nullptr)
    return context.front_end->family(axis->family);
  return fail(
      drive_error(Errc::usage, node, "which family is it?",
                  "a column family in the plan, -d FAMILY for all, or a cabinet file with this axis"));
}

void tell_moved_axis(Context& context, std::uint8_t node, std::uint8_t to,
                     std::optional<std::uint32_t> serial) {
  const auto cabinet = context.front_end->cabinet();
  const auto* axis = cabinet ? axis_on_line(context, **cabinet, node) : nullptr;
  if (axis == nullptr || (axis->serial && serial && *axis->serial != *serial)) return;
  context.notices.push_back(
      message("the cabinet file still has axis {} at node-ID {}: write the new one, {}, into it",
              as_it_is(axis->name), axis->node, to));
}

}  // namespace servoctl::command
