#pragma once

#include <span>
#include <string>
#include <vector>

#include "show/pdo_book.hpp"

/// What `pdo watch` and `pdo send` have in common.
namespace servoctl::pdo {

/// The PDOs of a node as read from the drive.
Result<std::vector<show::PdoView>> read_views(show::Desk& desk, std::uint8_t node);

/// The one of this name among the PDOs of a node. Errors as find_pdo().
Result<const show::PdoView*> find_view(std::span<const show::PdoView> views, std::uint8_t node,
                                       std::string_view name);

}  // namespace servoctl::pdo
