#include "drive/new_family.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/family_mistakes.hpp"

namespace servoctl::drive {
namespace fs = std::filesystem;
namespace {

tl::unexpected<Error> cannot_make(const fs::path& folder, int reason) {
  return fail(
      Errc::file,
      message("cannot write {}: {}", as_it_is(folder.string()), std::generic_category().message(reason)),
      "choose an existing folder you may write to");
}

/// A folder that is gone again unless it was moved to its place.
class DraftFolder {
 public:
  explicit DraftFolder(const fs::path& beside, const std::string& name)
      : outer_((beside / ("." + name + ".XXXXXX")).string()) {
    if (::mkdtemp(outer_.data()) == nullptr) {
      reason_ = errno;
      outer_.clear();
      return;
    }
    // mkdtemp() makes it for the user alone; the one inside has the mode that new folders have.
    std::error_code error;
    path_ = fs::path(outer_) / name;
    if (!fs::create_directory(path_, error)) reason_ = error.value();
  }
  ~DraftFolder() {
    std::error_code ignored;
    if (!outer_.empty()) fs::remove_all(outer_, ignored);
  }
  DraftFolder(const DraftFolder&) = delete;
  DraftFolder& operator=(const DraftFolder&) = delete;

  int reason() const { return reason_; }
  const fs::path& path() const { return path_; }

  /// Never onto what is there. 0, or the reason.
  int move_to(const fs::path& place) {
    constexpr unsigned kNoReplace = 1;  // RENAME_NOREPLACE of renameat2(2).
    if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, place.c_str(), kNoReplace) != 0) {
      // File systems that do not know the flag: rename() replaces an empty folder at most.
      if (errno != EINVAL || ::rename(path_.c_str(), place.c_str()) != 0) return errno;
    }
    return 0;
  }

 private:
  std::string outer_;
  fs::path path_;
  int reason_ = 0;
};

Result<void> check_draft(const NewFamily& family, const fs::path& draft, std::span<const fs::path> folders) {
  Message all;
  for (const auto& mistake : mistakes_of({family.name, draft / family.name}, folders)) {
    if (!mistake.breaks) continue;
    if (!all.empty()) all += "; ";
    all += mistake.message;
  }
  if (all.empty()) return {};
  return fail(Errc::file, message("nothing was written: {}", all), "correct the data sheet or the tables");
}

/// Writes the files into a draft beside others, and checks them.
Result<void> write_draft(const DraftFolder& draft, const fs::path& beside, const NewFamily& family,
                         std::span<const fs::path> folders) {
  if (draft.reason() != 0) return cannot_make(beside, draft.reason());
  for (const auto& [name, content] : family.files)
    if (const auto written = write_file_atomically(draft.path() / name, content); !written)
      return fail(written.error());
  return check_draft(family, draft.path(), folders);
}

Result<fs::path> free_place(const NewFamily& family, const fs::path& folder) {
  auto place = folder / family.name;
  std::error_code ignored;
  if (fs::exists(place, ignored))
    return fail(Errc::usage, message("{} exists", as_it_is(place.string())), "choose another name");
  return place;
}

/// Whether the folder is there, or could be made, and takes new folders.
Result<void> check_writable(const fs::path& folder) {
  std::error_code ignored;
  auto there = fs::absolute(folder, ignored);
  while (!fs::exists(there, ignored) && there.has_relative_path()) there = there.parent_path();
  if (!fs::is_directory(there, ignored)) return cannot_make(folder, ENOTDIR);
  if (::access(there.c_str(), W_OK | X_OK) != 0) return cannot_make(folder, errno);
  return {};
}

}  // namespace

Result<void> check_family_name(std::string_view name) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  // Where a family is named these are subcommands, the drive itself, all families, or a kind of bus.
  constexpr std::string_view kTaken[] = {"online", "check", "new", "all", "local", "sim"};
  const bool taken = std::find(std::begin(kTaken), std::end(kTaken), name) != std::end(kTaken);
  const bool begins = !name.empty() && name.front() >= 'a' && name.front() <= 'z';
  if (begins && std::all_of(name.begin(), name.end(), fits) && !taken) return {};
  if (taken)
    return fail(Errc::usage, message("'{}' cannot be the name of a family", as_it_is(name)),
                "the word means something else in commands: choose another name, such as p10");
  return fail(Errc::usage, message("'{}' cannot be the name of a family", as_it_is(name)),
              "lower case letters, digits, _ and -, beginning with a letter: p10, lxd7-can");
}

Result<fs::path> write_family(const NewFamily& family, const fs::path& folder,
                              std::span<const fs::path> folders) {
  auto place = free_place(family, folder);
  if (!place) return place;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return cannot_make(folder, error.value());
  // Not in the folder of the families: no other command finds half a family there.
  DraftFolder draft(folder.parent_path(), family.name);
  if (const auto sound = write_draft(draft, folder.parent_path(), family, folders); !sound)
    return fail(sound.error());
  if (const int reason = draft.move_to(*place); reason != 0) return cannot_make(*place, reason);
  return place;
}

Result<fs::path> try_family(const NewFamily& family, const fs::path& folder,
                            std::span<const fs::path> folders) {
  auto place = free_place(family, folder);
  if (!place) return place;
  for (const auto& one : {folder, folder.parent_path()})
    if (const auto writable = check_writable(one); !writable) return fail(writable.error());
  std::error_code error;
  const auto beside = fs::temp_directory_path(error);
  if (error) return cannot_make("$TMPDIR", error.value());
  const DraftFolder draft(beside, family.name);
  if (const auto sound = write_draft(draft, beside, family, folders); !sound) return fail(sound.error());
  return place;
}

}  // namespace servoctl::drive
