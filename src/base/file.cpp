#include "base/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

namespace servoctl {
namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using FilePtr = std::unique_ptr<std::FILE, Close>;

constexpr std::string_view kOtherFolder = "choose a folder that exists and that you may write to";

std::string why(int error) { return std::generic_category().message(error); }

}  // namespace

Result<std::string> read_file(const std::filesystem::path& path, std::uintmax_t max_bytes) {
  const FilePtr file(std::fopen(path.c_str(), "rbe"));
  if (!file) return fail(Errc::file, fmt::format("cannot open {}: {}", path.string(), why(errno)));
  std::string content;
  char chunk[65536];
  for (;;) {
    const std::size_t got = std::fread(chunk, 1, sizeof chunk, file.get());
    content.append(chunk, got);
    if (content.size() > max_bytes)
      return fail(Errc::file, fmt::format("{} is larger than {} bytes", path.string(), max_bytes));
    if (got < sizeof chunk) break;
  }
  if (std::ferror(file.get()) != 0)
    return fail(Errc::file, fmt::format("cannot read {}: {}", path.string(), why(errno)));
  return content;
}

Result<void> check_writable(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    return fail(Errc::file, fmt::format("cannot write {}: it is a folder", path.string()),
                "name a file in it");
  std::string temporary = path.string() + ".XXXXXX";
  const int fd = ::mkostemp(temporary.data(), O_CLOEXEC);
  if (fd < 0)
    return fail(Errc::file, fmt::format("cannot write {}: {}", path.string(), why(errno)),
                std::string(kOtherFolder));
  ::close(fd);
  ::unlink(temporary.c_str());
  return {};
}

Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view content) {
  std::string temporary = path.string() + ".XXXXXX";
  const int fd = ::mkostemp(temporary.data(), O_CLOEXEC);
  if (fd < 0)
    return fail(Errc::file, fmt::format("cannot write {}: {}", path.string(), why(errno)),
                std::string(kOtherFolder));
  int error = 0;
  while (!content.empty() && error == 0) {
    const auto wrote = ::write(fd, content.data(), content.size());
    if (wrote >= 0)
      content.remove_prefix(static_cast<std::size_t>(wrote));
    else if (errno != EINTR)
      error = errno;
  }
  if (error == 0 && ::fchmod(fd, 0644) != 0) error = errno;
  if (error == 0 && ::fsync(fd) != 0) error = errno;
  if (::close(fd) != 0 && error == 0) error = errno;
  if (error == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
  if (error == 0) return {};
  ::unlink(temporary.c_str());
  return fail(Errc::file, fmt::format("cannot write {}: {}", path.string(), why(error)));
}

}  // namespace servoctl
