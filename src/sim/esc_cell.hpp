#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "drive/profile.hpp"
#include "sim/esc_ring.hpp"
#include "sim/esc_slave.hpp"
#include "sim/memory.hpp"

namespace servoctl::sim {

/// Simulated drives in an EtherCAT ring with all that belongs to them.
struct EscCell {
  std::vector<std::shared_ptr<const drive::Profile>> profiles;  ///< One a family.
  std::unique_ptr<Memory> memory;
  std::vector<std::unique_ptr<EscSlave>> slaves;  ///< In the order of the ring.
  EscRing ring;
};

/// Builds slaves from `sv2@1,sv2@2?state=FILE&fault=0xFF00@2s&delay=20ms`: families with [coe] rules, and
/// their positions from 1 in their order; then options of the drives as build_cell()'s, and those of
/// apply_option(). They have power from `now` on. Errc::usage for what is wrong in the text.
Result<EscCell> build_esc_cell(std::string_view text, std::span<const std::filesystem::path> folders,
                               TimePoint now);

}  // namespace servoctl::sim
