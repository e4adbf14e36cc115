#pragma once

#include <span>

#include "settings/address_change.hpp"
#include "settings/address_journal.hpp"
#include "settings/address_plan.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// The messages of what is left of a plan, in their order: each step where the drive is by then, then the
/// bitrates. `profiles` are those of the rows. Only reads; errors as plan_address(), with the row.
Result<report::Value> planned_address_plan(show::Desk& desk, std::span<const AddressRow> rows,
                                           std::span<const drive::Profile* const> profiles,
                                           const AddressJournal& journal, bool unlock);

/// What the drives of a plan that get another bitrate have to be told, where each is now.
Result<std::vector<AddressChange>> planned_bitrates(show::Desk& desk, std::span<const AddressRow> rows,
                                                    std::span<const drive::Profile* const> profiles,
                                                    const AddressJournal& journal);

}  // namespace servoctl::settings
