#include "drive/shared_profile.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <mutex>
#include <string>
#include <system_error>
#include <utility>

#include "base/text.hpp"

namespace servoctl::drive {
namespace fs = std::filesystem;
namespace {

struct KnownProfiles {
  std::mutex mutex;
  std::map<std::string, std::shared_ptr<const Profile>> by_files;
};

/// Never destroyed: to take the tables apart at the end of the process would cost each command its time.
KnownProfiles& known_profiles() {
  static auto& known = *new KnownProfiles;
  return known;
}

/// What tells the files of a family from what they were before they were changed.
std::string state_of(const Family& family) {
  auto out = family.stem.string();
  const auto begin = family.stem.filename().string() + ".";
  std::error_code error;
  for (fs::directory_iterator it(family.stem.parent_path(), error), end; !error && it != end;
       it.increment(error)) {
    const auto name = it->path().filename().string();
    if (!name.starts_with(begin)) continue;
    std::error_code gone;
    const auto time = it->last_write_time(gone).time_since_epoch().count();
    out += fmt::format("\n{} {} {}", name, time, it->file_size(gone));
  }
  return out;
}

}  // namespace

Result<std::shared_ptr<const Profile>> shared_profile(std::string_view family,
                                                      std::span<const fs::path> folders) {
  const auto families = find_families(folders);
  const auto found = std::find_if(families.begin(), families.end(),
                                  [&](const Family& each) { return equals_nocase(each.name, family); });
  const auto share = [](Profile profile) { return std::make_shared<const Profile>(std::move(profile)); };
  if (found == families.end()) return load_profile(family, folders).map(share);
  auto& known = known_profiles();
  const std::lock_guard lock(known.mutex);
  auto key = state_of(*found);
  if (const auto before = known.by_files.find(key); before != known.by_files.end()) return before->second;
  auto loaded = load_profile(*found, folders).map(share);
  if (loaded) known.by_files.emplace(std::move(key), *loaded);
  return loaded;
}

}  // namespace servoctl::drive
