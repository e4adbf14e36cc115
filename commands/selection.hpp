#pragma once

#include <functional>
#include <string_view>

#include "commands/command.hpp"

namespace servoctl::commands {

/// Whether an object belongs to a part of a drive's settings; empty: all do.
using Selection = std::function<bool(ObjectAddress)>;

/// The option `--only`, for the commands that have it.
inline constexpr Parameter kOnlyOption{
    .name = "--only", .help = "communication, pdo, params, or a group of parameters", .kind = Kind::text};

/// `communication` (below 2000h), `pdo`, `params` or a group of the family's parameter table. Errc::usage for
/// another word. The profile must outlive the selection.
Result<Selection> selection_of(const drive::Profile& profile, std::string_view word);

}  // namespace servoctl::commands
