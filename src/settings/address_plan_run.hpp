#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "settings/address_change.hpp"
#include "settings/address_plan.hpp"

namespace servoctl::settings {

struct AddressPlanOptions {
  AddressOptions each;
  bool resume = false;  ///< Goes on with what the journal tells of.
};

/// Renumbers the drives of a plan, one after the other: looks at all first, shows the steps, asks once. Each
/// drive is found at its new address before the next one moves; bitrates are written at the end, at nodes
/// that do not restart any more. Ends with the first that fails; the journal beside the file stays then, and
/// `resume` goes on after it was put right. `text` is what stands in the file.
///
/// The answer has a row for each drive: `node new_node serial result`; with dry_run the frames. Errc::refused
/// where a journal stands and is not to be gone on with, where a new node-ID is taken, and as plan_address().
Result<report::Value> run_address_plan(show::Desk& desk, std::string_view text,
                                       const std::filesystem::path& file, const AddressPlanOptions& options);

}  // namespace servoctl::settings
