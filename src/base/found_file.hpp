#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"

/// Files that nobody named: found in a folder above, beside the program, in a folder for settings or state.
/// Who may have written them decides whether servoctl obeys them.
namespace servoctl {

/// Whether only root, this user or `also` can have written the file. With sudo the user who called it counts
/// as well ($SUDO_UID). Checked are the owner of the file and of a symbolic link to it, the right of others
/// to write to it, and to its folder where that has no sticky bit. A group may write only if it is the
/// owner's private group: same name as the user, no other member, and no access control list. Errc::refused
/// with who may write, and `way` as the hint; Errc::file when the file cannot be looked at.
Result<void> check_found_file(const std::filesystem::path& file, const Message& way,
                              std::optional<uid_t> also = std::nullopt);

/// The same of a folder in which servoctl keeps what it remembers: it must belong to this user alone, also
/// under sudo, because what root writes into the folder of another user may be redirected by a link there.
/// Errc::refused.
Result<void> check_own_folder(const std::filesystem::path& folder);

/// Errc::refused if the last part of the path is a symbolic link of another user (not root): it would decide
/// which file is written. A path without a link, or to nothing, is right.
Result<void> check_links(const std::filesystem::path& path);

/// As write_file_atomically(), for what servoctl keeps without being told to: a file of another user, also at
/// the end of a link, is left alone (Errc::refused).
Result<void> write_own_file(const std::filesystem::path& path, std::string_view content);

}  // namespace servoctl
