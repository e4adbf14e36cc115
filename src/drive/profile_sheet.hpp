#pragma once

#include <string>
#include <string_view>

#include "base/result.hpp"
#include "drive/profile.hpp"
#include "od/eds.hpp"

namespace servoctl::drive {

/// Whether it has controlword and statusword: the numbers from 6000h on mean other things in other profiles.
bool is_drive(const od::Dictionary& dictionary);

/// Takes dictionary and identity of a data sheet; what CiA 402 says of the objects both have is kept.
void take_sheet(Profile& profile, od::EdsFile& file);

/// Reads the data sheet of this name (od::sheet_name()) into the profile; of an ESI the way to the objects as
/// well. What was found in it is a warning of the profile.
Result<void> add_sheet(Profile& profile, const std::string& word);

/// How many errors and warnings a data sheet has, and which command shows them; empty: none. `word` names it.
std::string findings_text(const od::EdsFile& sheet, std::string_view word);

}  // namespace servoctl::drive
