#pragma once

#include <span>
#include <vector>

#include "settings/change.hpp"

namespace servoctl::settings {

/// The changes; where they are to be kept, behind them those of the parameters that the drive copies into
/// their objects at its start (od::Parameter::mirror): what is to survive power-off has to stand there too,
/// whatever 1010h stores. A parameter that is among the changes already stays as it is wanted there.
std::vector<Change> changes_with(const show::Desk& desk, std::span<const Change> changes,
                                 const WriteOptions& options);

}  // namespace servoctl::settings
