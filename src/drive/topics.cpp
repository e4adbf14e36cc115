#include "drive/topics.hpp"
#include "drive/family_files.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "base/file.hpp"
#include "base/folded.hpp"
#include "base/text.hpp"
#include "drive/topic_scope.hpp"

namespace servoctl::drive {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kTopicFile = ".topics.toml";

std::string family_of_file(const fs::path& path) {
  const auto name = path.filename().string();
  return lower(name.substr(0, name.size() - kTopicFile.size()));
}

using Parse = Result<std::vector<Topic>>(std::string_view toml, std::string_view file,
                                         std::string_view family);

Result<std::vector<Topic>> read_topic_file(const fs::path& path, Parse& parse = parse_topics) {
  const auto text = read_file(path);
  if (!text) return fail(text.error());
  return parse(*text, path.string(), family_of_file(path));
}

bool says_the_same(const Topic& a, const Topic& b) {
  return folded(a.name) == folded(b.name) ||
         (a.value && a.object == b.object && a.value == b.value && a.kind == b.kind);
}

/// The manual of a drive that names a method without drawing it leaves the drawing to the standard.
bool takes_the_place_of(const Topic& a, const Topic& b) {
  return says_the_same(a, b) && (!a.picture.empty() || b.picture.empty());
}

void add_behind(std::vector<Topic>& all, std::vector<Topic> more) {
  const auto own = all.size();
  for (auto& topic : more) {
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(own);
    if (std::none_of(all.begin(), end, [&](const Topic& known) { return takes_the_place_of(known, topic); }))
      all.push_back(std::move(topic));
  }
}

std::optional<fs::path> standard_file(std::span<const fs::path> folders) {
  std::error_code ignored;
  for (const auto& family : find_families(folders)) {
    if (family.name != kStandardFamily) continue;
    fs::path path = family.stem.string() + std::string(kTopicFile);
    if (fs::exists(path, ignored) && check_family_file(path)) return path;
  }
  return std::nullopt;
}

/// Of the family, its parents and the standard.
Result<std::vector<Topic>> read_all(const Profile& profile, std::span<const fs::path> folders, Parse& parse) {
  auto files = profile.topic_files;
  if (const auto standard = standard_file(folders);
      standard && std::find(files.begin(), files.end(), *standard) == files.end())
    files.push_back(*standard);
  std::vector<Topic> out;
  for (const auto& file : files) {
    auto topics = read_topic_file(file, parse);
    if (!topics) return fail(topics.error());
    add_behind(out, std::move(*topics));
  }
  remove_foreign_topics(out, profile);
  return out;
}

}  // namespace

Result<std::vector<Topic>> load_own_topics(const Profile& profile) {
  if (profile.topic_files.empty() || family_of_file(profile.topic_files.front()) != lower(profile.family))
    return std::vector<Topic>();
  return read_topic_file(profile.topic_files.front());
}

Result<std::vector<Topic>> load_topics(const Profile& profile, std::span<const fs::path> folders) {
  return read_all(profile, folders, parse_topics);
}

Result<std::vector<std::string>> topic_names(const Profile& profile, std::span<const fs::path> folders) {
  auto heads = read_all(profile, folders, parse_topic_heads);
  if (!heads) return fail(heads.error());
  std::vector<std::string> out;
  for (auto& head : *heads) out.push_back(std::move(head.name));
  return out;
}

}  // namespace servoctl::drive
