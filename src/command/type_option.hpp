#pragma once

#include <optional>
#include <string_view>

#include "command/command.hpp"
#include "od/data_type.hpp"

namespace servoctl::command {

inline constexpr std::string_view kTypeNames[] = {"bool", "i8",     "i16",   "i24",   "i32", "i64",
                                                  "u8",   "u16",    "u24",   "u32",   "u64", "f32",
                                                  "f64",  "string", "bytes", "domain"};

/// The type of `--type`; empty when it was not given. Errc::usage for an unknown one.
Result<std::optional<od::DataType>> parse_type_option(const Arguments& arguments);

}  // namespace servoctl::command
