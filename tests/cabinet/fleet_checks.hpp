#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "fleet.hpp"
#include "session/storage.hpp"

/// What tests of plans and applies ask of a fleet.
namespace servoctl::cabinet {

/// The objects that a table of a plan is about.
inline std::set<std::string> objects_of(const report::Value& table) {
  std::set<std::string> out;
  if (const auto* rows = table.table())
    for (const auto& row : rows->rows) out.insert(std::get<std::string>(row.front().data()));
  return out;
}

inline void expect_no_errors(const Fleet& fleet) {
  for (const auto& error : fleet.desk.errors)
    ADD_FAILURE() << error.message.text() << "; " << error.hint.text();
}

inline session::Values wanted_of(const PlannedAxis& look) {
  session::Values out;
  for (const auto& entry : look.plan->wanted.entries) out.emplace(entry.object, *entry.bytes);
  return out;
}

/// Writes another value into an object, as somebody at the panel might; false where the drive has no other.
inline bool change_at_the_panel(Fleet& fleet, std::size_t axis, ObjectAddress object) {
  const auto node = fleet.cabinet.axes[axis].node;
  auto& session = fleet.session(axis);
  const auto held = fleet.drive(axis).value(object);
  for (const std::uint64_t step : {std::uint64_t{1}, ~std::uint64_t{0}})
    if (session.download(node, object, store_le(load_le(held) + step, held.size()))) return true;
  return false;
}

/// After a power cycle: what no manual calls stored, the simulated drives forget, and the plan tells it.
inline void expect_kept(Fleet& fleet) {
  for (const auto& look : fleet.look()) {
    for (const auto& [object, data] : wanted_of(look)) {
      const bool differs = look.plan->present.at(object) != data;
      EXPECT_FALSE(differs && session::is_known_to_keep(family_of(look.axis->family), object))
          << look.axis->family << " " << to_string(object);
    }
  }
}

}  // namespace servoctl::cabinet
