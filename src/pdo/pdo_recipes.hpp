#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "drive/pdo_recipe.hpp"
#include "pdo/pdo_changing.hpp"

/// PDOs as they stand in files and presets.
namespace servoctl::pdo {

/// What the recipes make of the node's PDOs; where a family assigns fixed PDOs, those valid by the recipes
/// and no others. Errc::usage, with the PDO, for what the node does not have or cannot be.
Result<WantedPdos> follow(const drive::Profile& profile, const PresentPdos& present,
                          const std::vector<drive::PdoRecipe>& recipes);

/// Everything the values say of a PDO as a recipe, its CAN-ID by `$NODEID` where it contains the node-ID. A
/// mapping of which an entry is missing is not said at all.
drive::PdoRecipe recipe_of(const drive::Profile* profile, const PresentPdos& present,
                           const canopen::Pdo& pdo);

/// A file of PDOs, `.toml` or `.json`. Errc::file with file and line.
Result<drive::PdoFile> read_pdo_file(const std::filesystem::path& file);
/// The same for a text; the name of the file decides how it is read.
Result<drive::PdoFile> parse_pdo_file(std::string_view text, const std::filesystem::path& file);

/// All PDOs of a node as such a file, with the names of what they map.
struct SavedPdos {
  drive::PdoFile file;
  std::vector<std::vector<std::string>> names;  ///< One list for each recipe.
};
SavedPdos saved_pdos(const show::Desk& desk, const PresentPdos& present);

/// The text of such a file; `names` are those of the mapped objects, one list for each recipe.
std::string pdo_toml(const drive::PdoFile& file, const std::vector<std::vector<std::string>>& names);
std::string pdo_json(const drive::PdoFile& file);

}  // namespace servoctl::pdo
