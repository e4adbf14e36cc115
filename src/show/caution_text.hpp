#pragma once

#include <string>

#include "drive/profile.hpp"

namespace servoctl::show {

/// A caution of a family in words: what its setting makes of switches, motions and limits, how to end that,
/// and what its data says besides. In English or Chinese; one paragraph.
std::string caution_text(const drive::Profile& profile, const drive::Caution& caution, bool chinese);

/// `negative limit switch`, in English: for messages.
std::string_view name(drive::Input input);

/// What ends a caution: `Pn0603 = 0`; empty where its data does not tell.
std::string ending_setting(const drive::Caution& caution);
/// Whether that takes effect when the drive restarts.
bool needs_restart(const drive::Profile& profile, const drive::Caution& caution);

}  // namespace servoctl::show
