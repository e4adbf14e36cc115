// Where the data of the families are, which of them are trusted, and whose parents they are.
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <system_error>
#include <utility>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/found_file.hpp"
#include "base/text.hpp"
#include "drive/family_files.hpp"
#include "drive/profile.hpp"
#include "drive/rules.hpp"

namespace servoctl::drive {
namespace fs = std::filesystem;
namespace {

/// The program's own data: beside an installed program, or in the source tree of one that was just built.
std::optional<fs::path> own_folder() {
  std::error_code ignored;
  const auto program = fs::read_symlink("/proc/self/exe", ignored);
  if (ignored) return std::nullopt;
  for (auto folder = program.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    if (fs::is_directory(folder / "share/servoctl/eds", ignored)) return folder / "share/servoctl/eds";
    if (fs::is_directory(folder / "eds", ignored) && fs::exists(folder / "CMakeLists.txt", ignored))
      return folder / "eds";
  }
  return std::nullopt;
}

/// The folders of $SERVOCTL_DRIVES.
std::vector<fs::path> named_folders() {
  std::vector<fs::path> out;
  if (const char* own = std::getenv("SERVOCTL_DRIVES"); own != nullptr)
    for (const auto part : split(std::string_view(own), ':'))
      if (!part.empty()) out.emplace_back(part);
  return out;
}

/// Those that are there without a word: the user's own, and the program's. Looked for once.
const std::vector<fs::path>& found_folders() {
  static const auto found = [] {
    std::vector<fs::path> out;
    if (auto users = own_families_folder()) out.push_back(std::move(*users));
    if (auto own = own_folder()) out.push_back(std::move(*own));
    return out;
  }();
  return found;
}

bool is_below(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

/// Who can change the program can do whatever its data could.
std::optional<uid_t> owner_of_program() {
  static const auto owner = []() -> std::optional<uid_t> {
    struct stat info {};
    return ::stat("/proc/self/exe", &info) == 0 ? std::optional(info.st_uid) : std::nullopt;
  }();
  return owner;
}

/// Beside the files of a family, and none by itself.
constexpr std::string_view kTopics = ".topics.toml";

/// Adds the families of a folder; `inner`: where to put its folders.
void find_in(const fs::path& folder, std::vector<Family>& out, std::vector<fs::path>* inner) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (std::error_code not_a_folder; inner != nullptr && it->is_directory(not_a_folder))
      inner->push_back(it->path());
    const auto extension = it->path().extension();
    if (extension != ".eds" && extension != ".dcf" && extension != ".xml" && extension != ".toml") continue;
    if (it->path().string().ends_with(kTopics)) continue;
    const auto name = lower(it->path().stem().string());
    if (std::none_of(out.begin(), out.end(), [&](const Family& f) { return f.name == name; }))
      out.push_back({name, folder / it->path().stem()});
  }
}

/// Nothing where there are none or they are not trusted: who loads the family says so.
std::string text_of_rules(const Family& family) {
  const fs::path file = family.stem.string() + ".toml";
  if (!check_family_file(file)) return {};
  return read_file(file).value_or(std::string());
}

}  // namespace

Result<fs::path> own_families_folder() {
  if (const char* config = std::getenv("XDG_CONFIG_HOME"); config != nullptr && *config != '\0')
    return fs::path(config) / "servoctl/drives";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return fs::path(home) / ".config/servoctl/drives";
  return fail(Errc::usage, "there is no folder for your own families", "set HOME or XDG_CONFIG_HOME");
}

std::vector<fs::path> drive_folders() {
  auto out = named_folders();
  out.insert(out.end(), found_folders().begin(), found_folders().end());
  return out;
}

Result<void> check_family_file(const fs::path& file) {
  const auto& found = found_folders();
  const auto holds = [&](const fs::path& folder) { return is_below(file, folder); };
  const auto named = named_folders();
  if (std::any_of(named.begin(), named.end(), holds) || std::none_of(found.begin(), found.end(), holds))
    return {};
  return check_found_file(file,
                          message("nothing of these drive data was used; if you trust them, name their "
                                  "folder: SERVOCTL_DRIVES={}",
                                  as_it_is(file.parent_path().string())),
                          owner_of_program());
}

std::vector<Family> find_families(std::span<const fs::path> folders) {
  std::vector<Family> out;
  for (const auto& folder : folders) {
    std::vector<fs::path> inner;
    find_in(folder, out, &inner);
    for (const auto& each : inner) find_in(each, out, nullptr);
  }
  std::sort(out.begin(), out.end(), [](const Family& a, const Family& b) { return a.name < b.name; });
  return out;
}

const Family* find_family(std::span<const Family> families, std::string_view name) {
  const auto found = std::find_if(families.begin(), families.end(),
                                  [&](const Family& family) { return equals_nocase(family.name, name); });
  return found == families.end() ? nullptr : &*found;
}

Result<void> check_parents(const Family& family, std::span<const fs::path> folders) {
  const auto families = find_families(folders);
  std::string chain = family.name;
  std::string first;
  std::vector<std::string> seen;
  // A file that was named by its path may build on the family of the same name.
  if (const auto* known = find_family(families, family.name); known == nullptr || known->stem == family.stem)
    seen.push_back(family.name);
  const auto* at = &family;
  while (at != nullptr) {
    const auto parent = lower(parent_of(text_of_rules(*at)));
    if (parent.empty()) return {};
    if (first.empty()) first = parent;
    chain += " → " + parent;
    if (std::find(seen.begin(), seen.end(), parent) != seen.end())
      return fail(Errc::file,
                  message("{}: parent = \"{}\": the parents form a loop: {}",
                          message("{}.toml", as_it_is(family.stem.filename().string())), as_it_is(first),
                          as_it_is(chain)),
                  "name a parent that does not descend from this family");
    seen.push_back(parent);
    at = find_family(families, parent);
  }
  return {};
}

Folders::operator std::span<const fs::path>() const {
  if (given_) return *given_;
  static const auto found = drive_folders();
  return found;
}

}  // namespace servoctl::drive
