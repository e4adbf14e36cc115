#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

#include "settings/address_change.hpp"
#include "settings/address_plan.hpp"
#include "settings/bitrate_switch.hpp"

namespace servoctl::settings {

struct AddressPlanOptions {
  AddressOptions each;
  std::optional<std::uint32_t> bus_bitrate = {};  ///< As that of an AddressWish.
  /// The data of a row's family, and whether the drive at a node is one of it; null: that of the desk,
  /// unheld.
  std::function<Result<const drive::Profile*>(const AddressRow& row)> family_of = {};
  std::function<Result<void>(std::uint8_t node, const drive::Profile& family)> hold = {};
  /// Called at the end for each drive that has its new node-ID; null: nobody wants to know.
  std::function<void(const AddressRow& row, std::optional<std::uint32_t> serial)> moved = {};
  /// How the interface goes with the drives that get another bitrate, and who else receives on it, for the
  /// question; null: it stays.
  std::function<Result<BitrateSwitch>(std::span<const AddressChange> changes, std::uint32_t bitrate)>
      follower = {};
  std::function<std::string(const BitrateSwitch& follower)> beside = {};
  bool resume = false;  ///< Goes on with what the journal tells of.
};

/// Renumbers the drives of a plan, one after the other: looks at all first, shows the steps, asks once. Each
/// drive is found at its new address before the next one moves; bitrates are written at the end, at nodes
/// that do not restart any more, and when all are written the interface goes with them where it can. Ends
/// with the first that fails; the journal beside the file stays then, and
/// `resume` goes on after it was put right. `text` is what stands in the file.
///
/// The answer has a row for each drive: `node new_node family serial result`; with dry_run the frames.
/// Errc::refused where a journal stands and is not to be gone on with, where a new node-ID is taken, where a
/// row has another family than when it was begun, and as plan_address().
Result<report::Value> run_address_plan(show::Desk& desk, std::string_view text,
                                       const std::filesystem::path& file, const AddressPlanOptions& options);

}  // namespace servoctl::settings
