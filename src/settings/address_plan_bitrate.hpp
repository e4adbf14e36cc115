#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "settings/address_plan_run.hpp"

namespace servoctl::settings {

/// The end of a plan whose drives get another bitrate: the interface goes with them, or what to do by hand is
/// told.
class PlanBitrate {
 public:
  PlanBitrate(show::Desk& desk, const AddressPlanOptions& options) : desk_(&desk), options_(&options) {}

  /// Finds out whether the interface can follow; `changes` are those of the drives where they are now. Errors
  /// as AddressPlanOptions::follower.
  Result<void> look(std::span<const AddressChange> changes, std::uint32_t bitrate);
  /// What happens behind the writes, for a question; empty: nothing. And the same for a dry run.
  std::string then() const;
  void tell_commands() const;

  /// A drive of a row has it for its next start.
  void add(std::size_t row, AddressChange change, AddressOutcome outcome);
  /// All have: tells what became of each row. False where something failed that --resume goes on with: nobody
  /// is moved again, and the bitrates are found written.
  bool end(std::span<const AddressRow> rows,
           const std::function<void(std::size_t row, std::string_view)>& note);

 private:
  bool is_still_so();

  show::Desk* desk_;
  const AddressPlanOptions* options_;
  BitrateSwitch follower_;
  std::vector<std::size_t> rows_;  ///< Of the next two.
  std::vector<AddressChange> changes_;
  std::vector<AddressOutcome> outcomes_;
};

}  // namespace servoctl::settings
