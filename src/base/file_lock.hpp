#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/result.hpp"

namespace servoctl {

/// A file that only one process holds at a time. It goes away with this object; the one that a killed process
/// leaves behind binds nobody.
class FileLock {
 public:
  /// Empty when another process holds it. In a folder that nobody can write to nothing is held, and nobody is
  /// kept out: there is nothing to fight for. Errc::file when the file cannot be made for another reason.
  /// `holder` stands in the file, for those who find it held.
  static Result<std::optional<FileLock>> take(const std::filesystem::path& path,
                                              std::string_view holder = {});
  /// What stands in a file that is held; empty when that is nothing, or not yet.
  static std::string holder(const std::filesystem::path& path);

  FileLock(FileLock&& other) noexcept : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)) {}
  FileLock& operator=(FileLock&&) = delete;
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  ~FileLock();

 private:
  FileLock(std::filesystem::path path, int fd) : path_(std::move(path)), fd_(fd) {}

  std::filesystem::path path_;
  int fd_ = -1;  ///< -1: nothing is held.
};

}  // namespace servoctl
