#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "show/desk.hpp"

namespace servoctl::show {

/// The rule for every file that a line writes because its words say so: one that exists is replaced only
/// after a question (or --yes), and under --read-only not at all. What is no regular file (`/dev/null`, a
/// pipe) is written as it is, a block device counts
/// as a file; an empty file is written without a question. Errc::refused.
Result<void> may_replace(const std::filesystem::path& file, bool read_only, const Desk& desk);

/// Whether may_replace() would ask.
bool is_replaced(const std::filesystem::path& file);

}  // namespace servoctl::show
