#pragma once

#include "drive/profile.hpp"
#include "report/value.hpp"

namespace servoctl::show {

/// `0x2002:3B × 0x6091:02 / (0x6091:01), when …; …`: the ways to a measure, in words.
std::string ways_text(const drive::Quotients& ways);
/// The same of one of them.
std::string way_text(const drive::Quotient& way);

/// All rules of a family, for `drives FAMILY`.
report::Record rules_record(const drive::Profile& profile, bool chinese);

}  // namespace servoctl::show
