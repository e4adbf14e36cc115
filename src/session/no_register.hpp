#pragma once

#include <string_view>

namespace servoctl::session {

/// Why a value of a drive on Modbus is not known: in backups, and where it is shown.
inline constexpr std::string_view kNoRegister = "no Modbus register";

}  // namespace servoctl::session
