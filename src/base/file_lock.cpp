#include "base/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <system_error>

#include "base/file.hpp"
#include "base/format.hpp"

namespace servoctl {
namespace {

/// Whether the name still stands for the open file: who held it before may have taken it away since.
bool is_there(const std::filesystem::path& path, int fd) {
  struct stat open {};
  struct stat named {};
  return ::fstat(fd, &open) == 0 && ::lstat(path.c_str(), &named) == 0 && open.st_dev == named.st_dev &&
         open.st_ino == named.st_ino;
}

/// That it cannot be said keeps nobody from holding it.
void say_holder(int fd, std::string_view holder) {
  if (::ftruncate(fd, 0) == 0) (void)!::write(fd, holder.data(), holder.size());
}

}  // namespace

Result<std::optional<FileLock>> FileLock::take(const std::filesystem::path& path, std::string_view holder) {
  for (;;) {
    const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (fd < 0 && (errno == EACCES || errno == EROFS)) return std::optional(FileLock({}, -1));
    if (fd < 0)
      return fail(
          Errc::file,
          message("cannot open {}: {}", as_it_is(path.string()), std::generic_category().message(errno)),
          "choose an existing folder you may write to");
    if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      ::close(fd);
      if (error == EINTR) continue;
      if (error == EWOULDBLOCK) return std::optional<FileLock>();
      return fail(Errc::file, message("cannot lock {}: {}", as_it_is(path.string()),
                                      std::generic_category().message(error)));
    }
    if (is_there(path, fd)) {
      say_holder(fd, holder);
      return std::optional(FileLock(path, fd));
    }
    ::close(fd);
  }
}

std::string FileLock::holder(const std::filesystem::path& path) {
  constexpr std::uintmax_t kMostBytes = 4096;
  const auto text = read_file(path, kMostBytes);
  return text ? *text : std::string();
}

FileLock::~FileLock() {
  if (fd_ < 0) return;
  ::unlink(path_.c_str());
  ::close(fd_);
}

}  // namespace servoctl
