#include "drive/shared_profile.hpp"

#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "base/text.hpp"

namespace servoctl::drive {
namespace {

struct KnownProfiles {
  std::mutex mutex;
  std::map<std::string, std::shared_ptr<const Profile>> by_name_and_folders;
};

/// Never destroyed: to take the tables apart at the end of the process would cost each command its time.
KnownProfiles& known_profiles() {
  static auto& known = *new KnownProfiles;
  return known;
}

}  // namespace

Result<std::shared_ptr<const Profile>> shared_profile(std::string_view family,
                                                      std::span<const std::filesystem::path> folders) {
  auto key = lower(family);
  for (const auto& folder : folders) key += '\0' + folder.string();
  auto& known = known_profiles();
  const std::lock_guard lock(known.mutex);
  if (const auto found = known.by_name_and_folders.find(key); found != known.by_name_and_folders.end())
    return found->second;
  auto loaded = load_profile(family, folders);
  if (!loaded) return fail(loaded.error());
  auto profile = std::make_shared<const Profile>(std::move(*loaded));
  if (!profile->of_file) known.by_name_and_folders.emplace(std::move(key), profile);
  return profile;
}

}  // namespace servoctl::drive
