#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace servoctl {

/// The whole file. Errc::file with the reason when it cannot be read or is larger than `max_bytes`.
Result<std::string> read_file(const std::filesystem::path& path, std::uintmax_t max_bytes = 256U << 20U);

/// Whether write_file_atomically() could write there now; leaves nothing behind. What is no regular file is
/// not touched: whether somebody reads a pipe is known only when it is written to.
Result<void> check_writable(const std::filesystem::path& path);

/// Replaces a regular file in one step: written beside it, synced, renamed, its folder synced. On an error
/// the old file stands untouched. A new file is made as the umask says; one that is replaced keeps its mode,
/// and owner and group where that is allowed. One that may not be written to is refused, though its folder
/// would let it be replaced. A symbolic link stays, and what it leads to is replaced. Other names of the file
/// (hard links) keep what it held. What is no regular file (`/dev/null`, a FIFO, `/dev/stdout`) is written to
/// as it is: for at most 2 s without a reader.
Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view content);

}  // namespace servoctl
