#pragma once

#include <filesystem>

#include "drive/pdo_recipe.hpp"
#include "drive/profile.hpp"

namespace servoctl::pdo {

/// The PDOs that a file says, for any node: `.toml` or `.json` of `pdo save`, a backup, an `.eds`, `.dcf` or
/// `.xml`. Errc::file with file and line, Errc::negative for a file without PDOs, Errc::refused for one of
/// another family.
Result<drive::PdoFile> read_pdo_source(const drive::Profile& profile, const std::filesystem::path& file);

}  // namespace servoctl::pdo
