#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.hpp"
#include "drive/profile.hpp"
#include "session/identity.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// What the nodes are, as far as it tells a family: 1000h, 1018h:01 and :02, 1008h, and 1018h:03 where a mark
/// of the rules asks for it. Read in one transfer, all nodes at the same time, and kept in the session until
/// a node restarts; so is whether the family's own objects are there (Rules::identity_looks). A node that
/// does not answer has Errc::timeout. Where something was read, listens for a second node of the same number,
/// see settle_duplicates().
std::vector<Result<Identity>> identify(Session& session, std::span<const std::uint8_t> nodes,
                                       const drive::Rules& rules);

/// What tells this drive from others of its kind, asked anew: 1000h, 1008h, 1018h:01 to 04; it does not tell
/// what it refuses. Errors: there is no answer.
Result<Identity> read_identity(Session& session, std::uint8_t node);

/// Looks for the own objects of every family that the identity leaves open (Rules::identity_looks), by
/// reading them, all at the same time: what they are is noted in the identities, and kept in the session.
/// What is not answered stays unknown.
void look_for_families(Session& session, std::span<Identity> identities,
                       std::span<const drive::Family> families);

/// How long a second node of the same number is waited for, at least: answers of two drives of one kind are
/// close together; where somebody looks who is there, others have their time as well.
inline constexpr Duration kBriefly = std::chrono::milliseconds(2);
inline constexpr Duration kBeforeWrites = std::chrono::milliseconds(20);
inline constexpr Duration kThoroughly = std::chrono::milliseconds(20);
/// Where nothing is asked but who is there.
inline constexpr Duration kScanning = std::chrono::milliseconds(100);
/// Before a motor gets power, and before what is stored, or starts or restarts a drive: a slow one is heard
/// as well.
inline constexpr Duration kBeforeMotion = std::chrono::milliseconds(250);

/// Takes in what a second node of the same number may still answer to what was asked: for twice the time that
/// the slowest answer took, up to 20 ms, but at least for `least`, from the last answer on. Where one has
/// come twice, asks for what never changes to know better, and waits as long as the second answer took.
/// Errors of the bus.
Result<void> settle_duplicates(Session& session, std::span<const std::uint8_t> nodes, Duration least);

/// Errc::refused when two nodes were noticed under this number.
Result<void> refuse_duplicate(Session& session, std::uint8_t node);

}  // namespace servoctl::session
