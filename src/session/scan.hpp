#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drive/profile.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// What a node says of itself; each field is empty when the drive has no such object.
struct Identity {
  std::uint8_t node = 0;
  std::optional<std::uint32_t> device_type;   ///< 1000h
  std::optional<std::uint32_t> vendor_id;     ///< 1018h:01
  std::optional<std::uint32_t> product_code;  ///< 1018h:02
  std::optional<std::uint32_t> revision;      ///< 1018h:03
  std::optional<std::uint32_t> serial;        ///< 1018h:04
  std::string device_name;                    ///< 1008h
  std::string hardware_version;               ///< 1009h
  std::string software_version;               ///< 100Ah
  std::optional<canopen::NmtState> nmt;       ///< Heard from heartbeat or boot-up, if any.
};

/// Asks all `nodes` for 1000h at once, without retries: the answer takes one timeout however many there are.
/// A node that refuses the read is there as well. Then reads the identity of those found. Errc::bus when the
/// bus is lost.
Result<std::vector<Identity>> scan(Session& session, std::span<const std::uint8_t> nodes);

/// A family whose identity rule fits a node.
struct Guess {
  std::string family;
  bool certain = false;
};

/// Families that fit, certain ones first. Families whose rules cannot be read are left out.
std::vector<Guess> guess_families(const Identity& identity, std::span<const drive::Family> families);

}  // namespace servoctl::session
