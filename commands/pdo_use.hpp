#pragma once

#include <span>
#include <string>
#include <vector>

#include "commands/pdo_book.hpp"

/// What `pdo watch` and `pdo send` have in common.
namespace servoctl::commands {

/// The PDOs of a node as the drive tells them.
Result<std::vector<PdoView>> read_views(show::Desk& desk, std::uint8_t node);

/// The one of this name among the PDOs of a node. Errors as find_pdo().
Result<const PdoView*> find_view(std::span<const PdoView> views, std::uint8_t node, std::string_view name);

}  // namespace servoctl::commands
