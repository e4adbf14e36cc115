#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drive/profile.hpp"
#include "session/identity.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// Called with the nodes that were found and their 1000h and 1018h, before anything else is read of them.
using BeforeDetails = std::function<void(std::span<const Identity>)>;

/// Asks all `nodes` for 1000h at once, without retries: the answer takes one timeout however many there are.
/// A node that refuses the read is there as well. Then reads the identity of those found. Errc::bus when the
/// bus is lost. Why each of the others was not asked goes to `away`, which may be null. First 1018h is read,
/// then the names, of a drive that may be asked for them (consider_numbers()).
Result<std::vector<Identity>> scan(Session& session, std::span<const std::uint8_t> nodes,
                                   std::vector<Error>* away = nullptr,
                                   const BeforeDetails& before_details = {});

/// The node-IDs that answer scan(); on EtherCAT EtherCatNetwork::nodes_with_objects().
/// Errc::timeout when none does, Errc::bus when the bus is lost.
Result<std::vector<std::uint8_t>> nodes_present(Session& session);

/// The warning that names the nodes whose 1000h and 1018h fit no known family; empty if there is none.
std::string warning_of_details(std::span<const Identity> identities, std::span<const drive::Family> families);

/// A family whose identity rule fits a node, or whose own objects it has.
struct Guess {
  std::string family;
  bool certain = false;  ///< Its rules say that a match proves it, and no other family fits.
  bool generic = false;  ///< For drives of many makers.
};

/// Families that fit, certain ones first, generic ones last. Families whose rules cannot be read are left
/// out.
std::vector<Guess> guess_families(const Identity& identity, std::span<const drive::Family> families);

/// Families on EtherCAT whose vendor and product numbers are these: what an SII tells, which has no 1000h.
/// None is certain.
std::vector<Guess> guess_by_sii(const Identity& identity, std::span<const drive::Family> families);

}  // namespace servoctl::session
