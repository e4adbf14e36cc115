#include "base/file_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <system_error>

namespace servoctl {
namespace {

/// Whether the name still stands for the open file: who held it before may have taken it away since.
bool is_there(const std::filesystem::path& path, int fd) {
  struct stat open {};
  struct stat named {};
  return ::fstat(fd, &open) == 0 && ::lstat(path.c_str(), &named) == 0 && open.st_dev == named.st_dev &&
         open.st_ino == named.st_ino;
}

}  // namespace

Result<std::optional<FileLock>> FileLock::take(const std::filesystem::path& path) {
  for (;;) {
    const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (fd < 0 && (errno == EACCES || errno == EROFS)) return std::optional(FileLock({}, -1));
    if (fd < 0)
      return fail(Errc::file,
                  fmt::format("cannot open {}: {}", path.string(), std::generic_category().message(errno)),
                  "choose an existing folder you may write to");
    if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      ::close(fd);
      if (error == EINTR) continue;
      if (error == EWOULDBLOCK) return std::optional<FileLock>();
      return fail(Errc::file,
                  fmt::format("cannot lock {}: {}", path.string(), std::generic_category().message(error)));
    }
    if (is_there(path, fd)) return std::optional(FileLock(path, fd));
    ::close(fd);
  }
}

FileLock::~FileLock() {
  if (fd_ < 0) return;
  ::unlink(path_.c_str());
  ::close(fd_);
}

}  // namespace servoctl
