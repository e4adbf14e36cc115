#pragma once

#include <string>
#include <string_view>

namespace servoctl::drive {

/// What people write in cells of their tables, as the tables of a family have it. What is not known is handed
/// on as it is: the reader of the table says what it should be.

/// `UINT16`, `INTEGER32`, `DINT`: `u16`, `i32`, `i32`.
std::string family_type(std::string_view text);
/// `R/W`, `读写`: `rw`.
std::string family_access(std::string_view text);
/// `立即生效`, `power cycle`: `immediate`, `restart`.
std::string family_effect(std::string_view text);
/// `是`, `Y`: `yes`.
std::string family_answer(std::string_view text);
/// `警告`: `warning`.
std::string family_kind(std::string_view text);

}  // namespace servoctl::drive
