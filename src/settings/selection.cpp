#include "settings/selection.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <set>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/drive_settings.hpp"

namespace servoctl::settings {
namespace {

/// Manufacturer-specific profile area (CiA 301, table 31).
bool is_of_maker(ObjectAddress object) { return object.index >= 0x2000 && object.index < 0x6000; }

}  // namespace

Result<Selection> selection_of(const drive::Profile& profile, std::string_view word,
                               std::vector<std::string> further) {
  if (word.empty()) return Selection{};
  if (word == "communication")
    return Selection{[&profile](ObjectAddress object) {
      const auto* parameter = profile.parameter(object);
      const bool stored = parameter != nullptr && parameter->mirror;
      return (stored ? parameter->mirror->index : object.index) < 0x2000;
    }};
  if (word == "pdo")
    return Selection{[&profile](ObjectAddress object) { return drive::is_of_pdos(profile, object); }};
  if (word == "params")
    return Selection{[&profile](ObjectAddress object) {
      return profile.parameter(object) != nullptr || (profile.made_of_dictionary && is_of_maker(object));
    }};
  std::set<std::string> groups;
  for (const auto& parameter : profile.parameters)
    if (!parameter.group.empty()) groups.insert(parameter.group);
  if (groups.count(std::string(word)) == 0) {
    std::vector<std::string> parts{"communication", "pdo"};
    parts.insert(parts.end(), further.begin(), further.end());
    parts.emplace_back("params");
    parts.insert(parts.end(), groups.begin(), groups.end());
    return fail(Errc::usage, message("'{}' is not a part of the settings", as_it_is(word)),
                message("write one of {}", NameList{parts}));
  }
  return Selection{[&profile, group = std::string(word)](ObjectAddress object) {
    const auto* parameter = profile.parameter(object);
    return parameter != nullptr && parameter->group == group;
  }};
}

}  // namespace servoctl::settings
