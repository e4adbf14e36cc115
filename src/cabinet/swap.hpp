#pragma once

#include <filesystem>
#include <optional>

#include "cabinet/apply.hpp"
#include "settings/address_change.hpp"

namespace servoctl::cabinet {

/// How a new drive takes the place of an old one.
struct SwapOptions {
  std::optional<std::uint8_t> from = {};  ///< Where the new drive is; empty: at the node of the axis already.
  std::filesystem::path backup = {};      ///< A folder of `cabinet backup`; empty: what the file says.
  settings::AddressOptions address = {};
  ApplyOptions apply = {};
};

/// Puts a new drive into the place of an axis, step by step: it is held against the family of the axis, gets
/// the node of the axis where it has another one, and the values of the cabinet file as apply_cabinet() does
/// it, or all that a backup of the axis holds as a restore does it. Its serial number need not be the one in
/// the file; the line that is to be changed is told, and so is what cannot be put back. Each step asks. Begun
/// again after a failure it goes on: what is done is not done again.
///
/// The answer is `{axis node family serial_before serial address{…} settings}`; by --dry-run the frames of
/// the first step that sends any. Errc::refused for a drive of another family, and where both the old and the
/// new one are there; Errc::negative where the new one has to be switched off and on first.
Result<report::Value> swap_axis(show::Desk& desk, const Cabinet& cabinet, const Station& station,
                                const SwapOptions& options);

}  // namespace servoctl::cabinet
