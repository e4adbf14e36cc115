#pragma once

#include "drive/pdo_recipe.hpp"
#include "drive/toml_reader.hpp"

namespace servoctl::drive {

/// Reads one table of a recipe or a preset.
bool get(const toml::node& node, PdoRecipe& out);
bool get(const toml::node& node, PdoPreset& out);

}  // namespace servoctl::drive
