#include "drive/profile.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "drive/family_files.hpp"
#include "drive/maker_parameters.hpp"
#include "drive/parameter_ids.hpp"
#include "drive/profile_sheet.hpp"
#include "od/data_sheet.hpp"

namespace servoctl::drive {
namespace fs = std::filesystem;
namespace {

fs::path with_extension(const fs::path& stem, std::string_view extension) {
  return stem.string() + std::string(extension);
}

Result<void> add_dictionary(Profile& profile, const fs::path& path) {
  return add_sheet(profile, path.string());
}

Result<void> add_parameters(Profile& profile, const fs::path& path) {
  const auto text = read_file(path);
  if (!text) return fail(text.error());
  auto parameters = od::parse_parameters(*text, path.string());
  if (!parameters) return fail(parameters.error());
  std::vector<Error> same;
  refuse_same_ids(*parameters, path.string(), same);
  if (!same.empty()) return fail(std::move(same.front()));
  profile.parameters = std::move(*parameters);
  profile.made_of_dictionary = false;
  return {};
}

Result<void> add_object_notes(Profile& profile, const fs::path& path) {
  const auto text = read_file(path);
  if (!text) return fail(text.error());
  return od::annotate(profile.dictionary, *text, path.string());
}

Result<void> add_faults(Profile& profile, const fs::path& path) {
  const auto text = read_file(path);
  if (!text) return fail(text.error());
  auto faults = parse_faults(*text, path.string());
  if (!faults) return fail(faults.error());
  auto& inherited = profile.parent_faults;
  inherited.insert(inherited.begin(), profile.faults.begin(), profile.faults.end());
  profile.faults = std::move(*faults);
  return {};
}

Result<void> add_rules(Profile& profile, const fs::path& path, std::string_view text) {
  auto rules = parse_rules(text, path.string(), std::move(profile.rules));
  if (!rules) return fail(rules.error());
  profile.rules = std::move(*rules);
  return {};
}

/// Only `explain` reads them, see load_topics().
constexpr std::string_view kTopics = ".topics.toml";

constexpr std::string_view kSheetExtensions[] = {".eds", ".dcf", ".xml"};

struct Part {
  std::string_view extension;
  Result<void> (*add)(Profile&, const fs::path&);
};
/// In the order they need each other: the objects table annotates the dictionary.
constexpr Part kParts[] = {
    {".eds", add_dictionary},           {".dcf", add_dictionary},        {".xml", add_dictionary},
    {".objects.csv", add_object_notes}, {".params.csv", add_parameters}, {".faults.csv", add_faults},
};

/// One data sheet is enough: the first there is.
bool has_dictionary(const Part& part) {
  return std::find(std::begin(kSheetExtensions), std::end(kSheetExtensions), part.extension) !=
         std::end(kSheetExtensions);
}

Result<std::string> read_family_file(const fs::path& path) {
  if (const auto trusted = check_family_file(path); !trusted) return fail(trusted.error());
  return read_file(path);
}

Result<Profile> load_family(std::string_view name, std::span<const fs::path> folders, int ancestors);

Result<Profile> load_parent(const Family& family, std::string_view rules, std::span<const fs::path> folders,
                            int ancestors) {
  const auto parent = parent_of(rules);
  if (parent.empty()) return Profile{};
  if (const auto ends = ancestors == 0 ? check_parents(family, folders) : Result<void>(); !ends)
    return fail(ends.error());
  auto loaded = load_family(parent, folders, ancestors + 1);
  if (!loaded)
    return fail(loaded.error().code == Errc::refused ? Errc::refused : Errc::file,
                message("{}: parent: {}", as_it_is(rules_file(family).string()), loaded.error().message),
                loaded.error().hint);
  return loaded;
}

Result<Profile> load_parts(const Family& family, std::span<const fs::path> folders, int ancestors) {
  std::error_code ignored;
  const auto rules = rules_file(family);
  const bool has_rules = fs::exists(rules, ignored);
  const auto text = has_rules ? read_family_file(rules) : Result<std::string>();
  if (!text) return fail(text.error());
  auto parent = load_parent(family, *text, folders, ancestors);
  if (!parent) return parent;
  auto profile = std::move(*parent);
  if (!profile.family.empty()) profile.ancestors.insert(profile.ancestors.begin(), profile.family);
  profile.family = family.name;
  profile.warnings.clear();
  bool has_sheet = false;
  if (auto topics = with_extension(family.stem, kTopics); fs::exists(topics, ignored)) {
    if (const auto trusted = check_family_file(topics); !trusted) return fail(trusted.error());
    profile.topic_files.insert(profile.topic_files.begin(), std::move(topics));
  }
  if (has_rules)
    if (const auto added = add_rules(profile, rules, *text); !added) return fail(added.error());
  for (const auto& part : kParts) {
    const auto path = with_extension(family.stem, part.extension);
    if (!fs::exists(path, ignored)) continue;
    if (has_dictionary(part) && std::exchange(has_sheet, true)) continue;
    if (const auto trusted = check_family_file(path); !trusted) return fail(trusted.error());
    if (const auto added = part.add(profile, path); !added) return fail(added.error());
  }
  profile.build_index();
  return profile;
}

/// What is known of any drive, under another name.
Profile generic_profile(std::string family, std::span<const fs::path> folders) {
  Profile profile;
  if (auto generic = load_family(kGenericFamily, folders, 0))
    profile = std::move(*generic);
  else if (generic.error().code == Errc::refused)
    profile.warnings.push_back(generic.error().message.text());
  profile.family = std::move(family);
  profile.rules.name.clear();
  profile.rules.vendor.clear();
  profile.rules.name_zh.clear();
  profile.rules.identity.clear();
  profile.rules.identity_telling = false;
  profile.of_file = true;
  return profile;
}

/// A file of the user's own builds on what CiA 402 says of the objects it shares with it.
Result<Profile> load_single_file(const fs::path& path, std::span<const fs::path> folders) {
  if (lower(path.extension().string()) == ".toml") {
    const auto stem = fs::path(path).replace_extension();
    auto profile = load_parts({lower(stem.filename().string()), stem}, folders, 0);
    if (profile) profile->of_file = true;
    return profile;
  }
  auto profile = generic_profile(path.string(), folders);
  const bool table = lower(path.extension().string()) == ".csv";
  const auto added = table ? add_parameters(profile, path) : add_dictionary(profile, path);
  if (!added) return fail(added.error());
  if (!table && !is_drive(profile.dictionary)) profile.faults.clear();
  profile.build_index();
  return profile;
}

bool names_a_file(std::string_view family) {
  const auto folded = lower(family);
  return family.find('/') != std::string_view::npos || folded.ends_with(".eds") || folded.ends_with(".dcf") ||
         folded.ends_with(".csv") || folded.ends_with(".toml") ||
         od::sheet_name(folded).path.ends_with(".xml");
}

}  // namespace

bool Profile::is_generic() const { return rules.family.empty() || rules.family == kGenericFamily; }

bool Profile::descends_from(std::string_view other) const {
  return equals_nocase(family, other) ||
         std::any_of(ancestors.begin(), ancestors.end(),
                     [&](const auto& ancestor) { return equals_nocase(ancestor, other); });
}

void Profile::build_index() {
  if (parameters.empty() || made_of_dictionary) {
    parameters = maker_parameters(dictionary);
    made_of_dictionary = !parameters.empty();
  }
  // The lines of a data sheet are not those of a manual.
  if (made_of_dictionary && of_file)
    for (auto& parameter : parameters) parameter.line = 0;
  by_id_.clear();
  by_object_.clear();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    by_id_.emplace(canonical_id(parameters[i].id), i);
    if (parameters[i].object && !parameters[i].placed) by_object_.emplace(*parameters[i].object, i);
  }
}

const od::Parameter* Profile::parameter(std::string_view id) const {
  const auto found = by_id_.find(canonical_id(id));
  return found == by_id_.end() ? nullptr : &parameters[found->second];
}

const od::Parameter* Profile::parameter(ObjectAddress object) const {
  const auto found = by_object_.find(object);
  return found == by_object_.end() ? nullptr : &parameters[found->second];
}

namespace {

/// To a family with faults of its own and no parent those of CiA 402. Without them it is as good as before.
void add_standard_faults(Profile& profile, std::span<const fs::path> folders) {
  if (profile.is_generic() || profile.faults.empty() || !profile.parent_faults.empty()) return;
  const auto families = find_families(folders);
  const auto* generic = find_family(families, kGenericFamily);
  if (generic == nullptr) return;
  const auto path = with_extension(generic->stem, ".faults.csv");
  const auto text = read_family_file(path);
  if (!text) return;
  if (auto faults = parse_faults(*text, path.string())) profile.parent_faults = std::move(*faults);
}

Result<Profile> load_family(std::string_view family, std::span<const fs::path> folders, int ancestors) {
  const auto families = find_families(folders);
  if (const auto* found = find_family(families, family)) {
    auto profile = load_parts(*found, folders, ancestors);
    if (profile && ancestors == 0) add_standard_faults(*profile, folders);
    return profile;
  }
  std::vector<std::string> names;
  for (const auto& known : families) names.push_back(known.name);
  auto hint = did_you_mean(family, names);
  if (hint.empty())
    hint =
        names.empty()
            ? std::string(
                  "no drive data was found: set SERVOCTL_DRIVES to its folder, or name an .eds or .xml file")
            : "known families: " + one_of(names) + "; or name an .eds or .xml file";
  return fail(Errc::usage, message("no drive family is called '{}'", as_it_is(family)), std::move(hint));
}

}  // namespace

const Fault* Profile::parent_fault(std::uint16_t code) const {
  const auto fault = std::find_if(parent_faults.begin(), parent_faults.end(),
                                  [code](const Fault& one) { return one.code == code; });
  return fault == parent_faults.end() ? nullptr : &*fault;
}

Result<Profile> load_profile(std::string_view family, std::span<const fs::path> folders) {
  if (names_a_file(family)) return load_single_file(fs::path(family), folders);
  return load_family(family, folders, 0);
}

Result<Profile> load_profile(const Family& family, std::span<const fs::path> folders) {
  auto profile = load_parts(family, folders, 0);
  if (profile) add_standard_faults(*profile, folders);
  return profile;
}

Profile profile_of_sheet(od::EdsFile sheet, std::string name, std::span<const fs::path> folders) {
  auto profile = generic_profile(std::move(name), folders);
  take_sheet(profile, sheet);
  if (!is_drive(profile.dictionary)) profile.faults.clear();
  profile.build_index();
  return profile;
}

fs::path rules_file(const Family& family) { return with_extension(family.stem, ".toml"); }

Result<Rules> load_rules(const Family& family) {
  const auto path = rules_file(family);
  const auto text = read_family_file(path);
  if (!text) return fail(text.error());
  return parse_rules(*text, path.string());
}

}  // namespace servoctl::drive
