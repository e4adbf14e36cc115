#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace servoctl {

/// The whole file. Errc::file with the reason when it cannot be read or is larger than `max_bytes`.
Result<std::string> read_file(const std::filesystem::path& path, std::uintmax_t max_bytes = 256U << 20U);

/// Whether write_file_atomically() could write there now; leaves nothing behind.
Result<void> check_writable(const std::filesystem::path& path);

/// Replaces the file in one step: written beside it, synced, renamed. On an error the old file stands
/// untouched.
Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view content);

}  // namespace servoctl
