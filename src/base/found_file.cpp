#include "base/found_file.hpp"

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <vector>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/number.hpp"

namespace servoctl {
namespace {

namespace fs = std::filesystem;

constexpr uid_t kRoot = 0;

/// Who called sudo; nobody where servoctl does not run as root.
std::optional<uid_t> sudo_user() {
  const char* text = std::getenv("SUDO_UID");
  if (text == nullptr || ::geteuid() != kRoot) return std::nullopt;
  const auto number = parse_digits(text, 10);
  return number && *number < static_cast<uid_t>(-1) ? std::optional(static_cast<uid_t>(*number))
                                                    : std::nullopt;
}

Message user_name(uid_t user) {
  const auto* entry = ::getpwuid(user);
  return entry == nullptr ? message("the user {}", user) : message("the user {}", as_it_is(entry->pw_name));
}

/// User private groups: Debian gives each user a group of the same name, and a umask of 002 may go with it.
bool is_private_group(uid_t user, gid_t group) {
  const auto* entry = ::getpwuid(user);
  if (entry == nullptr) return false;
  const std::string name = entry->pw_name;
  const auto* found = entry->pw_gid == group ? ::getgrgid(group) : nullptr;
  if (found == nullptr || name != found->gr_name) return false;
  for (char** member = found->gr_mem; *member != nullptr; ++member)
    if (name != *member) return false;
  return true;
}

/// With a list the mode of the group is the most that anybody in the list may do.
bool has_access_list(const fs::path& path) {
  return ::getxattr(path.c_str(), "system.posix_acl_access", nullptr, 0) > 0;
}

/// Who else may write to it; empty: nobody.
std::string writers(const fs::path& path, const struct stat& info) {
  if ((info.st_mode & S_IWOTH) != 0) return "every user";
  if ((info.st_mode & S_IWGRP) == 0) return {};
  if (has_access_list(path)) return "users of its access control list";
  if (is_private_group(info.st_uid, info.st_gid)) return {};
  const auto* group = ::getgrgid(info.st_gid);
  return group == nullptr ? formatted("the group {}", info.st_gid)
                          : formatted("the group {}", group->gr_name);
}

tl::unexpected<Error> foreign(const fs::path& path, uid_t owner, const Message& way) {
  return fail(Errc::refused,
              message("{} belongs to {}, not to you", as_it_is(path.string()), user_name(owner)), way);
}

tl::unexpected<Error> writable(const fs::path& path, const std::string& by, const Message& way) {
  return fail(Errc::refused, message("{} can be changed by {}", as_it_is(path.string()), by), way);
}

tl::unexpected<Error> unknown(const fs::path& path) {
  return fail(Errc::file, message("{}: {}", as_it_is(path.string()), std::generic_category().message(errno)));
}

fs::path folder_of(const fs::path& file) {
  auto parent = file.parent_path();
  return parent.empty() ? fs::path(".") : parent;
}

}  // namespace

Result<void> check_found_file(const fs::path& file, const Message& way, std::optional<uid_t> also) {
  const auto caller = sudo_user();
  const auto is_trusted = [&](uid_t owner) {
    return owner == ::geteuid() || owner == kRoot || owner == caller || owner == also;
  };
  struct stat info {};
  if (::lstat(file.c_str(), &info) != 0) return unknown(file);
  if (S_ISLNK(info.st_mode) && !is_trusted(info.st_uid)) return foreign(file, info.st_uid, way);
  if (::stat(file.c_str(), &info) != 0) return unknown(file);
  if (!is_trusted(info.st_uid)) return foreign(file, info.st_uid, way);
  if (const auto others = writers(file, info); !others.empty()) return writable(file, others, way);
  const auto folder = folder_of(file);
  if (::stat(folder.c_str(), &info) != 0) return unknown(folder);
  constexpr mode_t kAll = S_IWOTH | S_ISVTX;
  if ((info.st_mode & kAll) == S_IWOTH) return writable(folder, "every user", way);
  return {};
}

Result<void> check_own_folder(const fs::path& folder) {
  constexpr std::string_view kWay = "set XDG_STATE_HOME to a folder of your own";
  struct stat info {};
  if (::lstat(folder.c_str(), &info) != 0) return unknown(folder);
  if (S_ISLNK(info.st_mode) && info.st_uid != ::geteuid()) return foreign(folder, info.st_uid, kWay);
  if (::stat(folder.c_str(), &info) != 0) return unknown(folder);
  if (info.st_uid != ::geteuid()) return foreign(folder, info.st_uid, kWay);
  if (const auto others = writers(folder, info); !others.empty()) return writable(folder, others, kWay);
  return {};
}

Result<void> check_links(const fs::path& path) {
  constexpr int kMostLinks = 40;
  const auto caller = sudo_user();
  auto at = path;
  for (int links = 0; links < kMostLinks; ++links) {
    struct stat info {};
    if (::lstat(at.c_str(), &info) != 0 || !S_ISLNK(info.st_mode)) return {};
    // What the kernel makes (/proc/self/fd/1) belongs to this process, also where it has changed its user.
    const bool own = info.st_uid == ::geteuid() || info.st_uid == ::getuid() || info.st_uid == kRoot;
    if (!own && info.st_uid != caller)
      return fail(Errc::refused,
                  message("cannot write {}: {} is a link of {}", as_it_is(path.string()),
                          as_it_is(at.string()), user_name(info.st_uid)),
                  "name the file that is to be written");
    std::error_code error;
    const auto next = fs::read_symlink(at, error);
    if (error) return {};
    at = at.parent_path() / next;
  }
  return {};
}

Result<void> write_own_file(const fs::path& path, std::string_view content) {
  constexpr std::string_view kWay = "move it away: servoctl keeps its own files there";
  struct stat info {};
  if (::lstat(path.c_str(), &info) == 0 && info.st_uid != ::geteuid())
    return foreign(path, info.st_uid, kWay);
  if (::stat(path.c_str(), &info) == 0 && info.st_uid != ::geteuid()) return foreign(path, info.st_uid, kWay);
  return write_file_atomically(path, content);
}

}  // namespace servoctl
