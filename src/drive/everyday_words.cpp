#include "drive/everyday_words.hpp"

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

#include "base/csv.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/family_files.hpp"
#include "drive/topics.hpp"

namespace servoctl::drive {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kWordsFile = ".words.csv";
constexpr std::string_view kTopicsEnd = ".topics.toml";

void add_to(std::vector<EverydayWords>& all, EverydayWords more) {
  const auto known =
      std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.name == more.name; });
  if (known == all.end()) return all.push_back(std::move(more));
  std::move(more.words.begin(), more.words.end(), std::back_inserter(known->words));
  known->absent = known->absent || more.absent;
}

/// Of the standard first, then of the parents, then of the family. Topics show what the parents are.
std::vector<fs::path> word_files(const Profile& profile, std::span<const fs::path> folders) {
  std::vector<fs::path> out;
  const auto add = [&](const std::string& stem) {
    if (fs::path path = stem + std::string(kWordsFile); std::find(out.begin(), out.end(), path) == out.end())
      out.push_back(std::move(path));
  };
  const auto families = find_families(folders);
  const auto add_family = [&](std::string_view name) {
    for (const auto& family : families)
      if (family.name == lower(name)) add(family.stem.string());
  };
  add_family(kStandardFamily);
  for (auto file = profile.topic_files.rbegin(); file != profile.topic_files.rend(); ++file)
    if (const auto path = file->string(); path.ends_with(kTopicsEnd))
      add(path.substr(0, path.size() - kTopicsEnd.size()));
  add_family(profile.family);
  return out;
}

}  // namespace

std::vector<EverydayWords> read_everyday_words(std::string_view csv, std::string_view file,
                                               std::vector<Error>& errors) {
  const auto table = read_csv(csv, file, errors);
  std::vector<EverydayWords> out;
  const auto wrong = [&](std::uint32_t line, const Message& what) {
    errors.push_back(file_error(file, line, what));
  };
  if (table.columns != std::vector<std::string>{"thing", "words", "manual"}) {
    if (!table.columns.empty()) wrong(1, "the columns are not thing,words,manual");
    return out;
  }
  for (const auto& row : table.rows) {
    EverydayWords words{std::string(trim(row.cells[0])), {}, row.cells[2] == "none"};
    if (words.name.empty()) wrong(row.line, "'thing' is missing");
    if (!row.cells[2].empty() && !words.absent) wrong(row.line, "'manual' is none, or empty");
    if (std::any_of(out.begin(), out.end(), [&](const auto& each) { return each.name == words.name; }))
      wrong(row.line, message("'{}' appears twice", as_it_is(words.name)));
    for (const auto word : split(std::string_view(row.cells[1]), ';'))
      if (const auto bare = trim(word); !bare.empty()) words.words.emplace_back(bare);
    out.push_back(std::move(words));
  }
  return out;
}

Result<std::vector<EverydayWords>> parse_everyday_words(std::string_view csv, std::string_view file) {
  std::vector<Error> errors;
  auto out = read_everyday_words(csv, file, errors);
  if (!errors.empty()) return fail(std::move(errors.front()));
  return out;
}

Result<std::vector<EverydayWords>> load_everyday_words(const Profile& profile,
                                                       std::span<const fs::path> folders) {
  std::vector<EverydayWords> out;
  std::error_code ignored;
  for (const auto& path : word_files(profile, folders)) {
    if (!fs::exists(path, ignored)) continue;
    if (const auto trusted = check_family_file(path); !trusted) return fail(trusted.error());
    const auto text = read_file(path);
    if (!text) return fail(text.error());
    auto words = parse_everyday_words(*text, path.string());
    if (!words) return fail(words.error());
    for (auto& each : *words) add_to(out, std::move(each));
  }
  return out;
}

}  // namespace servoctl::drive
