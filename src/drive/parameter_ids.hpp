#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "od/parameter.hpp"

namespace servoctl::drive {

/// The id without what people leave out: case, `_` and `-`, leading zeros of each number (`Pn0202` and
/// `pn_202` are one).
std::string canonical_id(std::string_view id);

/// Adds an error for each parameter whose number is that of an earlier one (canonical_id()): `P1-1` after
/// `P1-01`.
void refuse_same_ids(std::span<const od::Parameter> parameters, std::string_view file,
                     std::vector<Error>& errors);

/// An error for each parameter whose number a command would not take for it, or would take for it in place of
/// an object: an address or a name of another object, `all`, or an option.
std::vector<Error> shadowing_ids(std::span<const od::Parameter> parameters, const od::Dictionary& dictionary,
                                 std::string_view file);

}  // namespace servoctl::drive
