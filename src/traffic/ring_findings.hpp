#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/time.hpp"
#include "session/ethercat_network.hpp"
#include "traffic/finding.hpp"

/// What the registers of its slaves, read twice, say of an EtherCAT ring. Rules without I/O.
namespace servoctl::traffic {

/// What was seen of a ring in a while.
struct RingFacts {
  std::vector<session::EtherCatNetwork::Seen> first;
  std::vector<session::EtherCatNetwork::Seen> last;
  std::size_t least = 0;  ///< Slaves that answered: the fewest and the most.
  std::size_t most = 0;
  std::uint64_t sent = 0;  ///< Frames meanwhile.
  std::uint64_t lost = 0;
  std::uint64_t damaged = 0;
  Duration length{};
};

std::vector<Finding> ring_findings(const RingFacts& facts);

/// Where nothing came back at all; `link`: whether the port has a link, where that is known.
Finding no_ring(const std::string& url, std::optional<bool> link, const Error& error);

}  // namespace servoctl::traffic
