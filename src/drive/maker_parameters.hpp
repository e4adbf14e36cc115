#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "od/dictionary.hpp"
#include "od/parameter.hpp"

namespace servoctl::drive {

/// A name that begins with the number that the maker's manual and panel use.
struct NumberedName {
  std::string id;    ///< `Pr1.01`
  std::string name;  ///< `1st velocity loop gain`
};

/// Splits `Pr1.01 1st velocity loop gain`, `P00-01:Control mode`, `[C00.01] 控制模式`, `Pn100速度环增益`.
/// Letters, then digits in two groups or at least two of them; empty for any other name.
std::optional<NumberedName> split_number(std::string_view name);

/// Whether a word is written like a number of a panel (`Fn_50`, `P0.03`): it is that one or none, and no part
/// of a name.
bool looks_like_number(std::string_view word);

/// Parameters of a dictionary without a parameter table: the entries of the manufacturer's range (2000h to
/// 5FFFh). One whose name begins with a number of its own is known by that; any other one, and those whose
/// number another entry has as well, by its address (od::Parameter::placed).
std::vector<od::Parameter> maker_parameters(const od::Dictionary& dictionary);

}  // namespace servoctl::drive
