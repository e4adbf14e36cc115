#include "base/file.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cstdio>
#include <ctime>
#include <optional>
#include <system_error>
#include <utility>

#include "base/format.hpp"
#include "base/found_file.hpp"
#include "base/number.hpp"
#include "base/regular_files.hpp"
#include "base/text.hpp"

namespace servoctl {
namespace {

namespace fs = std::filesystem;

/// Closed at its end.
struct OpenFile {
  explicit OpenFile(int opened) : descriptor(opened) {}
  ~OpenFile() {
    if (descriptor >= 0) ::close(descriptor);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int descriptor;
};

/// Where nobody asked for a file, none is worth a longer wait.
constexpr std::uintmax_t kMostUnasked = std::uintmax_t{32} << 20U;

constexpr auto kAsItIs = static_cast<uid_t>(-1);  ///< Also of a group.
constexpr std::string_view kOtherFolder = "choose an existing folder you may write to";
/// How long a pipe, a terminal or a device may take nothing.
constexpr auto kPatience = std::chrono::seconds(2);

std::string why(int error) { return std::generic_category().message(error); }

std::string advice(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT: return "make room on the disk, or name a file on another one";
    case EFBIG: return "the file size limit (ulimit -f) was reached";
    case ETIMEDOUT:
    case ENXIO: return "it has no reader: start the reader first";
    default: return std::string(kOtherFolder);
  }
}

tl::unexpected<Error> cannot_write(const fs::path& path, int error) {
  return fail(Errc::file, message("cannot write {}: {}", as_it_is(path.string()), why(error)), advice(error));
}

/// Where a file is written to.
struct Target {
  enum class Kind { regular, descriptor, other };
  fs::path path;  ///< At the end of all links.
  Kind kind = Kind::regular;
  int descriptor = -1;                     ///< Of ours, for `/dev/stdout` and the like.
  std::optional<struct stat> before = {};  ///< Of the regular file that is replaced.
};

/// The descriptor of this process that a path such as `/proc/self/fd/1` names.
std::optional<int> own_descriptor(const fs::path& path) {
  const auto folder = path.parent_path().string();
  if (folder != "/proc/self/fd" && folder != "/dev/fd" && folder != formatted("/proc/{}/fd", ::getpid()))
    return std::nullopt;
  const auto number = parse_digits(path.filename().string(), 10);
  return number && *number <= INT_MAX ? std::optional(static_cast<int>(*number)) : std::nullopt;
}

/// Follows the links of the last part, to a file that does not exist as well.
Result<Target> target_of(const fs::path& path) {
  constexpr int kMostLinks = 40;
  if (const auto links = check_links(path); !links) return fail(links.error());
  Target out{.path = path};
  std::error_code error;
  for (int links = 0;; ++links) {
    if (const auto number = own_descriptor(out.path)) {
      out.kind = Target::Kind::descriptor;
      out.descriptor = *number;
      return out;
    }
    if (!fs::is_symlink(out.path, error)) break;
    if (links == kMostLinks) return cannot_write(path, ELOOP);
    const auto next = fs::read_symlink(out.path, error);
    if (error) return cannot_write(path, error.value());
    out.path = out.path.parent_path() / next;
  }
  struct stat info {};
  if (::stat(out.path.c_str(), &info) != 0) {
    if (errno != ENOENT) return cannot_write(path, errno);
    if (!out.path.has_filename())
      return fail(Errc::file, message("cannot write {}: it is a folder", as_it_is(path.string())),
                  "name a file in it");
    return out;
  }
  if (S_ISDIR(info.st_mode))
    return fail(Errc::file, message("cannot write {}: it is a folder", as_it_is(path.string())),
                "name a file in it");
  if (S_ISREG(info.st_mode))
    out.before = info;
  else
    out.kind = Target::Kind::other;
  // Who took the right to write from a file means the file, though its folder would let it be replaced.
  if (::faccessat(AT_FDCWD, out.path.c_str(), W_OK, AT_EACCESS) != 0) return cannot_write(path, errno);
  return out;
}

/// A file beside the target, which becomes it or goes away.
class Temporary {
 public:
  explicit Temporary(const Target& target) : target_(&target) {
    // Short, so that there is room for it wherever there is for the name of the target.
    const auto begin = std::chrono::steady_clock::now().time_since_epoch().count();
    constexpr int kMostTries = 100;
    for (int i = 0; i < kMostTries && fd_ < 0; ++i) {
      path_ = folder() / formatted(".servoctl-{}-{:x}", ::getpid(), begin + i);
      fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
                   target.before ? 0600 : 0666);
      if (fd_ < 0 && errno != EEXIST) break;
    }
    error_ = fd_ < 0 ? errno : 0;
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  ~Temporary() {
    if (fd_ >= 0) ::close(fd_);
    if (!path_.empty() && exists_) ::unlink(path_.c_str());
  }

  /// errno of what went wrong; 0: nothing.
  int error() const { return error_; }

  void fill(std::string_view content) {
    exists_ = error_ == 0;
    while (!content.empty() && error_ == 0) {
      const auto wrote = ::write(fd_, content.data(), content.size());
      if (wrote >= 0)
        content.remove_prefix(static_cast<std::size_t>(wrote));
      else if (errno != EINTR)
        error_ = errno;
    }
  }

  /// What replaces a file belongs to whom it belonged, and is open to whom it was.
  void take_mode() {
    if (error_ != 0 || !target_->before) return;
    const auto& before = *target_->before;
    struct stat now {};
    if (::fstat(fd_, &now) != 0) error_ = errno;
    const bool same_owner = now.st_uid == before.st_uid || ::fchown(fd_, before.st_uid, kAsItIs) == 0;
    const bool same_group = now.st_gid == before.st_gid || ::fchown(fd_, kAsItIs, before.st_gid) == 0;
    mode_t mode = before.st_mode & 07777U;
    // A right of one group is none of another.
    if (!same_owner || !same_group) mode &= ~static_cast<mode_t>(S_ISUID | S_ISGID);
    if (!same_group) mode &= ~static_cast<mode_t>(S_IRWXG);
    // Some file systems know no modes; there what is not wider than before will do.
    if (::fchmod(fd_, mode) != 0 && (now.st_mode & 0777U & ~mode) != 0) error_ = errno;
  }

  void replace() {
    // Some file systems have nothing to sync.
    if (error_ == 0 && ::fsync(fd_) != 0 && errno != EINVAL) error_ = errno;
    if (fd_ >= 0 && ::close(std::exchange(fd_, -1)) != 0 && error_ == 0) error_ = errno;
    if (error_ == 0 && std::rename(path_.c_str(), target_->path.c_str()) != 0) error_ = errno;
    if (error_ != 0) return;
    exists_ = false;
    sync_folder();
  }

 private:
  fs::path folder() const {
    const auto parent = target_->path.parent_path();
    return parent.empty() ? fs::path(".") : parent;
  }
  /// The new name is on the disk after that; a folder that may not be read, or cannot be synced, is left to
  /// its file system.
  void sync_folder() {
    const int fd = ::open(folder().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0) return;
    if (::fsync(fd) != 0 && errno != EINVAL && errno != EROFS) error_ = errno;
    ::close(fd);
  }

  const Target* target_;
  fs::path path_;
  int fd_ = -1;
  int error_ = 0;
  bool exists_ = false;
};

/// Writes to what takes bytes as they come; errno, or 0.
int write_plainly(int fd, std::string_view content) {
  while (!content.empty()) {
    pollfd ready{fd, POLLOUT, 0};
    const auto patience = std::chrono::duration_cast<std::chrono::milliseconds>(kPatience).count();
    const int waited = ::poll(&ready, 1, static_cast<int>(patience));
    if (waited < 0 && errno != EINTR) return errno;
    if (waited == 0) return ETIMEDOUT;
    if (waited < 0) continue;
    // There is room for that much in a pipe that is ready.
    const auto wrote = ::write(fd, content.data(), std::min<std::size_t>(content.size(), PIPE_BUF));
    if (wrote >= 0)
      content.remove_prefix(static_cast<std::size_t>(wrote));
    else if (errno != EINTR && errno != EAGAIN)
      return errno;
  }
  return 0;
}

/// Opens what is no regular file; a FIFO nobody reads yet is waited for. The descriptor, or -1 with errno.
int open_plainly(const fs::path& path) {
  constexpr timespec kSlice{0, 10'000'000};
  const auto end = std::chrono::steady_clock::now() + kPatience;
  for (;;) {
    const int fd = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (fd >= 0 || (errno != ENXIO && errno != EINTR) || std::chrono::steady_clock::now() >= end) return fd;
    ::nanosleep(&kSlice, nullptr);
  }
}

Result<void> write_through(const fs::path& path, const Target& target, std::string_view content) {
  const bool own = target.kind == Target::Kind::descriptor;
  const int fd = own ? target.descriptor : open_plainly(target.path);
  if (fd < 0) return cannot_write(path, errno);
  int error = write_plainly(fd, content);
  if (!own && ::close(fd) != 0 && error == 0) error = errno;
  if (error != 0) return cannot_write(path, error);
  return {};
}

}  // namespace

Result<std::string> read_file(const std::filesystem::path& path, std::uintmax_t max_bytes) {
  const bool regular_only = RegularFilesOnly::hold();
  struct stat found {};
  const auto is_regular = [&](int error) { return error != 0 || S_ISREG(found.st_mode); };
  // Before it is opened, and behind that: another may stand there now.
  if (regular_only && !is_regular(::stat(path.c_str(), &found)))
    return fail(Errc::file, message("{} is no regular file", as_it_is(path.string())));
  const OpenFile file(
      ::open(path.c_str(), O_RDONLY | O_CLOEXEC | (regular_only ? O_NONBLOCK | O_NOCTTY : 0)));
  if (file.descriptor < 0)
    return fail(Errc::file, message("cannot open {}: {}", as_it_is(path.string()), why(errno)));
  if (regular_only && !is_regular(::fstat(file.descriptor, &found)))
    return fail(Errc::file, message("{} is no regular file", as_it_is(path.string())));
  if (regular_only) max_bytes = std::min(max_bytes, kMostUnasked);
  std::string content;
  char chunk[65536];
  for (;;) {
    const auto got = ::read(file.descriptor, chunk, sizeof chunk);
    if (got < 0) return fail(Errc::file, message("cannot read {}: {}", as_it_is(path.string()), why(errno)));
    if (got == 0) return content;
    content.append(chunk, static_cast<std::size_t>(got));
    if (content.size() > max_bytes)
      return fail(Errc::file, message("{} is larger than {} bytes", as_it_is(path.string()), max_bytes));
  }
}

Result<void> check_writable(const std::filesystem::path& path) {
  const auto target = target_of(path);
  if (!target) return fail(target.error());
  if (target->kind == Target::Kind::other) return {};
  if (target->kind == Target::Kind::descriptor) {
    const int flags = ::fcntl(target->descriptor, F_GETFL);
    if (flags < 0) return cannot_write(path, errno);
    if ((flags & O_ACCMODE) == O_RDONLY) return cannot_write(path, EBADF);
    return {};
  }
  Temporary file(*target);
  file.fill({});
  if (file.error() != 0) return cannot_write(path, file.error());
  return {};
}

Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view content) {
  const auto target = target_of(path);
  if (!target) return fail(target.error());
  if (target->kind != Target::Kind::regular && RegularFilesOnly::hold())
    return fail(Errc::file, message("{} is no regular file", as_it_is(path.string())));
  if (target->kind != Target::Kind::regular) return write_through(path, *target, content);
  Temporary file(*target);
  file.fill(content);
  file.take_mode();
  file.replace();
  if (file.error() != 0) return cannot_write(path, file.error());
  return {};
}

}  // namespace servoctl
