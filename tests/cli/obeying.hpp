#pragma once

#include <string>
#include <string_view>

namespace servoctl {

/// The options with which a simulated drive of this family obeys 6040h: `sim:ts@1?panel=Fn_00=20`. As
/// delivered, some select another source of commands.
inline std::string obeying(std::string_view family) {
  if (family == "ts") return "?panel=Fn_00=20";
  if (family == "da200") return "?panel=P0.03=7";
  return {};
}

}  // namespace servoctl
