#pragma once

#include <cstdint>
#include <vector>

#include "session/write_plan.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// COB-IDs of the PDOs and the emergencies of a node, as far as the family has them and the drive tells.
/// Errors as Session::upload(), but for refusals.
Result<session::Values> read_own_cob_ids(show::Desk& desk, std::uint8_t node);

/// Those with the node-ID in them that hold what they held before the node got another one.
std::vector<ObjectAddress> left_behind(std::uint8_t node, const session::Values& before,
                                       const session::Values& now);

}  // namespace servoctl::settings
