#include "can/local_directory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <iterator>

#include "base/format.hpp"

namespace servoctl::can {
namespace {

constexpr std::string_view kMemberPrefix = "member-";

bool is_own_directory(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode) && info.st_uid == ::geteuid();
}

/// Looks beyond the environment: a service and a shell of the same user must meet on the same bus.
std::string base_path() {
  const char* const named = std::getenv("XDG_RUNTIME_DIR");
  if (named != nullptr && *named == '/' && is_own_directory(named)) return formatted("{}/servoctl", named);
  const auto usual = formatted("/run/user/{}", ::geteuid());
  if (is_own_directory(usual)) return usual + "/servoctl";
  return formatted("/tmp/servoctl-{}", ::geteuid());
}

tl::unexpected<Error> cannot_use(const std::string& path, const Message& why) {
  return fail(Errc::bus, message("cannot use {} for the bus: {}", as_it_is(path), why),
              "remove it, or set XDG_RUNTIME_DIR to your own directory for all processes on the bus");
}

Result<Descriptor> open_private(const std::string& path) {
  if (::mkdir(path.c_str(), 0700) != 0 && errno != EEXIST) return cannot_use(path, system_text(errno));
  Descriptor directory(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (!directory) return cannot_use(path, system_text(errno));
  struct stat info {};
  if (::fstat(directory.get(), &info) != 0) return cannot_use(path, system_text(errno));
  if (info.st_uid != ::geteuid()) return cannot_use(path, "it belongs to another user");
  if ((info.st_mode & 0077U) != 0) return cannot_use(path, "other users have access to it");
  return directory;
}

/// Reaches the file through the open directory, so that the length of its path does not matter: sun_path has
/// 108 bytes.
sockaddr_un address_of(int directory, std::string_view member) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  fmt::format_to_n(std::begin(address.sun_path), sizeof address.sun_path - 1, "/proc/self/fd/{}/{}",
                   directory, member);
  return address;
}

/// The one way in which the socket interface takes addresses of all families.
const sockaddr* generic(const sockaddr_un& address) { return reinterpret_cast<const sockaddr*>(&address); }

}  // namespace

Result<void> check_local_name(std::string_view name) {
  constexpr std::string_view kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  if (!name.empty() && name.size() <= 32 && name.find_first_not_of(kAllowed) == std::string_view::npos)
    return {};
  return fail(Errc::usage, message("'{}' cannot be the name of a local bus", as_it_is(name)),
              "use 1 to 32 of these: A-Z a-z 0-9 . _ -");
}

Result<LocalDirectory> LocalDirectory::open(std::string_view bus_name) {
  const auto base = base_path();
  if (const auto parent = open_private(base); !parent) return fail(parent.error());
  auto path = formatted("{}/bus-{}", base, bus_name);
  auto directory = open_private(path);
  if (!directory) return fail(directory.error());
  Descriptor lock(::openat(directory->get(), "lock", O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600));
  if (!lock) return cannot_use(path + "/lock", system_text(errno));
  Listing listing(::fdopendir(directory->get()));
  if (!listing) return cannot_use(path, system_text(errno));
  directory->release();
  return LocalDirectory(std::move(path), std::move(listing), std::move(lock));
}

bool LocalDirectory::try_lock() const { return ::flock(lock_.get(), LOCK_EX | LOCK_NB) == 0; }

void LocalDirectory::unlock() const { ::flock(lock_.get(), LOCK_UN); }

Result<std::string> LocalDirectory::join(int socket) const {
  // A name is taken when this process has joined before, or when a dead one with its process id left the
  // file.
  for (int count = 0;; ++count) {
    auto member = formatted("{}{}-{}", kMemberPrefix, ::getpid(), count);
    const auto address = address_of(::dirfd(listing_.get()), member);
    if (::bind(socket, generic(address), sizeof address) == 0) return member;
    if (errno != EADDRINUSE) return cannot_use(path_ + "/" + member, system_text(errno));
  }
}

std::vector<std::string> LocalDirectory::members() const {
  std::vector<std::string> names;
  ::rewinddir(listing_.get());
  while (const dirent* entry = ::readdir(listing_.get())) {
    const std::string_view name(std::begin(entry->d_name));
    if (name.starts_with(kMemberPrefix)) names.emplace_back(name);
  }
  return names;
}

void LocalDirectory::remove(const std::string& member) const {
  ::unlinkat(::dirfd(listing_.get()), member.c_str(), 0);
}

Result<void> LocalDirectory::bind(int socket, const std::string& name) const {
  remove(name);
  const auto address = address_of(::dirfd(listing_.get()), name);
  if (::bind(socket, generic(address), sizeof address) == 0) return {};
  return cannot_use(path_ + "/" + name, system_text(errno));
}

int LocalDirectory::connect(int socket, const std::string& name) const {
  const auto address = address_of(::dirfd(listing_.get()), name);
  return ::connect(socket, generic(address), sizeof address) == 0 ? 0 : errno;
}

LocalDirectory::Delivery LocalDirectory::deliver(int socket, std::span<const std::uint8_t> datagram,
                                                 const std::string& member) const {
  const auto address = address_of(::dirfd(listing_.get()), member);
  const auto sent = ::sendto(socket, datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                             generic(address), sizeof address);
  if (sent >= 0) return Delivery::done;
  return errno == ECONNREFUSED || errno == ENOENT || errno == EPROTOTYPE ? Delivery::gone : Delivery::full;
}

}  // namespace servoctl::can
