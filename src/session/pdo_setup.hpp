#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopen/pdo.hpp"
#include "drive/profile.hpp"
#include "session/session.hpp"
#include "session/write_plan.hpp"

namespace servoctl::session {

/// Reads the PDO parameters of nodes, 1400h to 1BFFh and what assigns fixed PDOs, all nodes at the same time.
/// Where the profile knows PDOs, those are read, and one the drive refuses is left out; without a profile
/// (may be null), or with one that knows none, the numbers are tried from 1 until several in a row are not
/// there. Of a mapping only the entries in use are read. A node that does not answer to the end has an error
/// instead. What a node has is told to CanNetwork::learn_pdos().
std::vector<Result<Values>> read_pdo_values(Session& session, const drive::Profile* profile,
                                            std::span<const std::uint8_t> nodes);

/// The PDOs these values describe, by communication index: RPDOs first, the numbers with whatever holes they
/// have. A PDO without COB-ID (a family that assigns fixed PDOs by 1C12h and 1C13h) stays invalid: it has no
/// CAN-ID, and may be longer than a frame. A mapping of which an entry is missing is taken as not known:
/// empty.
std::vector<canopen::Pdo> pdos_of(const Values& values);

/// All PDOs of the nodes; errors as in read_pdo_values().
std::vector<Result<std::vector<canopen::Pdo>>> read_pdos(Session& session, const drive::Profile* profile,
                                                         std::span<const std::uint8_t> nodes);
Result<std::vector<canopen::Pdo>> read_pdos(Session& session, const drive::Profile* profile,
                                            std::uint8_t node);

/// The PDO parameters a drive leaves the factory with, as far as its data tells; an object of which the
/// manual states no default is left out.
Values default_pdo_values(const drive::Profile& profile, std::uint8_t node);

/// The mapping records that a drive without communication records exchanges, by these values: what the
/// objects of PdoRules::assign_rpdo and assign_tpdo list. Empty for other families, or where nothing is
/// assigned.
std::vector<std::uint16_t> assigned_pdos(const drive::Profile* profile, const Values& values);

/// The object that lists the assigned PDOs of a direction, sub-index 0; empty for families without.
std::optional<ObjectAddress> assignment_of(const drive::Profile* profile, canopen::PdoDirection direction);

}  // namespace servoctl::session
