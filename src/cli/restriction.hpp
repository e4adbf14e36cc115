#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "command/arguments.hpp"

namespace servoctl::command {
struct Command;
}

namespace servoctl::cli {

/// What the lines of `run FILE --restricted` may touch: the buses that the run was given, and files below the
/// folder of FILE.
class Restriction {
 public:
  /// `folder` as it is now, without links; `buses` are URLs.
  Restriction(const std::filesystem::path& folder, const std::vector<std::string>& buses);

  /// Errc::refused for a bus that the run was not given.
  Result<void> check_bus(std::string_view url) const;
  /// Errc::refused for a file that is not below the folder, or is reached by a link that leads out of it.
  Result<void> check_file(const std::filesystem::path& file) const;
  /// The same for a family, which may be named by a file.
  Result<void> check_family(std::string_view family) const;
  /// All files that the words of a line name, and whether the command keeps to one bus at all.
  Result<void> check_words(const command::Command& command, const command::Arguments& arguments) const;

  /// That of the run that is under way; null: none is restricted.
  static const Restriction* current() { return current_; }

 private:
  friend class RestrictedRun;
  inline static const Restriction* current_ = nullptr;

  std::filesystem::path folder_;
  std::vector<std::string> buses_;  ///< canonical_url() of each.
};

/// While one of these lives with a restriction, it holds for every line of this process: a prompt runs one
/// batch file at a time.
class RestrictedRun {
 public:
  explicit RestrictedRun(std::optional<Restriction> restriction) : restriction_(std::move(restriction)) {
    if (restriction_) Restriction::current_ = &*restriction_;
  }
  RestrictedRun(const RestrictedRun&) = delete;
  RestrictedRun& operator=(const RestrictedRun&) = delete;
  ~RestrictedRun() { Restriction::current_ = nullptr; }

 private:
  std::optional<Restriction> restriction_;
};

}  // namespace servoctl::cli
