#pragma once

#include "drive/pdo_recipe.hpp"
#include "drive/toml_reader.hpp"

namespace servoctl::drive {

/// Reads one table of a recipe or a preset.
bool get(const toml::node& node, PdoRecipe& out);
bool get(const toml::node& node, PdoPreset& out);

/// Reads a list of recipes. Errc::file names the line of what cannot be read, and of a recipe without `pdo`.
Result<void> read_recipes(const toml::array& list, std::string_view file, std::vector<PdoRecipe>& out);

}  // namespace servoctl::drive
