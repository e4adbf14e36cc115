#include "show/output_file.hpp"

#include <system_error>

#include "base/format.hpp"

namespace servoctl::show {
namespace {

namespace fs = std::filesystem;

std::string question_about(const fs::path& file) {
  std::error_code error;
  if (!fs::is_symlink(file, error)) return formatted("Replace the file {}?", file.string());
  const auto target = fs::canonical(file, error);
  return formatted("Replace the file {}, to which the link {} leads?", target.string(), file.string());
}

}  // namespace

bool is_replaced(const fs::path& file) {
  std::error_code error;
  const auto status = fs::status(file, error);
  // An empty file holds nothing that could be lost.
  return fs::is_block_file(status) || (fs::is_regular_file(status) && fs::file_size(file, error) > 0);
}

Result<void> may_replace(const fs::path& file, bool read_only, const Desk& desk) {
  if (!is_replaced(file)) return {};
  if (read_only)
    return fail(Errc::refused,
                message("{} exists, and --read-only replaces no file", as_it_is(file.string())),
                "name a file that does not exist yet");
  return desk.confirm(question_about(file));
}

}  // namespace servoctl::show
