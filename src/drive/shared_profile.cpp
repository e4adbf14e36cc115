#include "drive/shared_profile.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <string>
#include <system_error>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"

namespace servoctl::drive {
namespace fs = std::filesystem;
namespace {

template <typename Read>
Result<std::shared_ptr<const Read>> share(Result<Read> read) {
  return std::move(read).map([](Read value) { return std::make_shared<const Read>(std::move(value)); });
}

/// What was read, by the state of the files that it stands in.
template <typename Read>
struct Known {
  std::mutex mutex;
  std::map<std::string, std::shared_ptr<const Read>> by_files;
};

/// Never destroyed: to take the tables apart at the end of the process would cost each command its time.
template <typename Read>
Known<Read>& known() {
  static auto& all = *new Known<Read>;
  return all;
}

/// As it was read before, or what `load` gives now, which is kept where it could be read.
template <typename Read, typename Load>
Result<std::shared_ptr<const Read>> known_or(std::string key, const Load& load) {
  auto& all = known<Read>();
  const std::lock_guard lock(all.mutex);
  if (const auto before = all.by_files.find(key); before != all.by_files.end()) return before->second;
  auto loaded = share(load());
  if (loaded) all.by_files.emplace(std::move(key), *loaded);
  return loaded;
}

std::string state_of(const fs::path& file) {
  struct stat info {};
  if (::stat(file.c_str(), &info) != 0) info = {};
  return formatted("\n{} {}.{} {}", file.filename().string(), info.st_mtim.tv_sec, info.st_mtim.tv_nsec,
                   info.st_size);
}

/// What tells the files of a family from what they were before they were changed.
std::string state_of(const Family& family) {
  auto out = family.stem.string();
  const auto begin = family.stem.filename().string() + ".";
  std::error_code error;
  for (fs::directory_iterator it(family.stem.parent_path(), error), end; !error && it != end;
       it.increment(error)) {
    if (it->path().filename().string().starts_with(begin)) out += state_of(it->path());
  }
  return out;
}

}  // namespace

Result<std::shared_ptr<const Profile>> shared_profile(std::string_view family,
                                                      std::span<const fs::path> folders) {
  const auto families = find_families(folders);
  const auto found = std::find_if(families.begin(), families.end(),
                                  [&](const Family& each) { return equals_nocase(each.name, family); });
  if (found == families.end()) return share(load_profile(family, folders));
  return known_or<Profile>(state_of(*found), [&] { return load_profile(*found, folders); });
}

Result<std::shared_ptr<const Rules>> shared_rules(const Family& family) {
  const auto file = rules_file(family);
  return known_or<Rules>(file.parent_path().string() + state_of(file), [&] { return load_rules(family); });
}

}  // namespace servoctl::drive
