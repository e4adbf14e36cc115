#include "drive/named.hpp"

#include <algorithm>
#include <set>

#include "base/folded.hpp"
#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "drive/maker_parameters.hpp"
#include "drive/name_key.hpp"

namespace servoctl::drive {
namespace {

bool is_plain(const od::Object& object) {
  return object.entries.size() == 1 && object.entries.front().address.sub == 0;
}

/// Whether it holds a value of its own, not the number of the entries behind it.
bool is_value(const od::Object& object, const od::Entry& entry) {
  return is_plain(object) || entry.address.sub != 0;
}

void add_once(std::vector<Target>& targets, const Profile& profile, ObjectAddress address) {
  if (std::none_of(targets.begin(), targets.end(), [&](const Target& t) { return t.address == address; }))
    targets.push_back(target_at(&profile, address));
}

/// Entries of `object` that `part` names: exactly, or as a piece of one name.
std::vector<const od::Entry*> entries_named(const od::Object& object, const std::string& part) {
  std::vector<const od::Entry*> pieces;
  for (const auto& entry : object.entries) {
    const auto name = name_key(entry.name);
    if (name == part) return {&entry};
    if (entry.address.sub != 0 && has_words(name, {part})) pieces.push_back(&entry);
  }
  return pieces;
}

/// Objects by their whole name, else by the name before a dot of it, behind which an entry is named.
std::vector<Target> objects_named(const Profile& profile, std::string_view text) {
  std::vector<Target> out;
  const auto key = name_key(text);
  if (key.empty()) return out;
  for (const auto& object : profile.dictionary.objects())
    if (name_key(object.name) == key)
      for (const auto& entry : object.entries)
        if (is_value(object, entry)) out.push_back(target_at(&profile, entry.address));
  for (auto dot = text.find('.'); out.empty() && dot != std::string_view::npos;
       dot = text.find('.', dot + 1)) {
    const auto before = name_key(text.substr(0, dot));
    const auto part = name_key(text.substr(dot + 1));
    for (const auto& object : profile.dictionary.objects())
      if (!before.empty() && name_key(object.name) == before)
        for (const auto* entry : entries_named(object, part))
          out.push_back(target_at(&profile, entry->address));
  }
  return out;
}

/// What the names for Chinese readers are compared by; some of them have no Chinese in them (`RPDO1 COB-ID`).
std::string chinese_key(std::string_view text) {
  auto out = folded(text);
  std::erase(out, ' ');
  return out;
}

/// Entries by their own name, alone or behind that of their object, and what is called so for Chinese
/// readers.
std::vector<Target> entries_and_chinese(const Profile& profile, std::string_view text) {
  std::vector<Target> out;
  const auto key = name_key(text);
  const auto chinese = chinese_key(text);
  if (key.empty() || chinese.empty()) return out;
  for (const auto& parameter : profile.parameters)
    if (parameter.object && !parameter.name_zh.empty() && chinese_key(parameter.name_zh) == chinese)
      add_once(out, profile, *parameter.object);
  for (const auto& object : profile.dictionary.objects())
    for (const auto& entry : object.entries)
      if ((!entry.name_zh.empty() && chinese_key(entry.name_zh) == chinese) ||
          (is_value(object, entry) &&
           (name_key(entry.name) == key || name_key(object.name + " " + entry.name) == key)))
        add_once(out, profile, entry.address);
  return out;
}

bool is_meant(const od::Parameter& parameter, const std::vector<std::string>& words) {
  return has_words(name_key(parameter.id + " " + parameter.name) + "\n" + chinese_key(parameter.name_zh),
                   words);
}

}  // namespace

std::vector<Target> named_wholly(const Profile& profile, std::string_view text, Match match) {
  auto out = objects_named(profile, text);
  // Makers call their parameters as the standard calls its objects: what is written must be meant.
  const bool all = profile.of_file && match == Match::whole;
  if (!out.empty() && !all) return out;
  const auto key = name_key(text);
  for (const auto& parameter : profile.parameters)
    if (parameter.object && !key.empty() && name_key(parameter.name) == key)
      add_once(out, profile, *parameter.object);
  if (!out.empty() && !all) return out;
  for (const auto& target : entries_and_chinese(profile, text)) add_once(out, profile, target.address);
  return out;
}

std::vector<Target> named_in_part(const Profile& profile, std::string_view text) {
  std::vector<Target> out;
  const auto words = key_words(text);
  for (const auto& parameter : profile.parameters)
    if (parameter.object && is_meant(parameter, words)) add_once(out, profile, *parameter.object);
  for (const auto& object : profile.dictionary.objects())
    for (const auto& entry : object.entries)
      if (is_value(object, entry) &&
          has_words(name_key(object.name + " " + entry.name) + "\n" + chinese_key(entry.name_zh), words))
        add_once(out, profile, entry.address);
  return out;
}

std::vector<const od::Parameter*> parameters_named(const Profile& profile, std::string_view text,
                                                   Match match) {
  std::vector<const od::Parameter*> out;
  const auto collect = [&](const auto& fits) {
    for (const auto& parameter : profile.parameters)
      if (fits(parameter)) out.push_back(&parameter);
  };
  const auto key = name_key(text);
  const auto chinese = chinese_key(text);
  if (key.empty()) return out;
  collect([&](const auto& parameter) { return name_key(parameter.name) == key; });
  if (out.empty()) collect([&](const auto& parameter) { return chinese_key(parameter.name_zh) == chinese; });
  if (!out.empty() || match == Match::whole || looks_like_number(text)) return out;
  const auto words = key_words(text);
  collect([&](const auto& parameter) { return is_meant(parameter, words); });
  return out;
}

Message near_names(const Profile& profile, std::string_view text, bool objects) {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> near;
  const auto add = [&](std::string name) {
    if (near.size() < kMost && std::find(near.begin(), near.end(), name) == near.end())
      near.push_back(std::move(name));
  };
  const auto wanted = chinese_key(text);
  const auto look_at = [&](const std::string& name_zh) {
    const auto key = chinese_key(name_zh);
    if (!key.empty() && !wanted.empty() && (key.find(wanted) != std::string::npos || wanted.starts_with(key)))
      add(name_zh);
  };
  for (const auto& parameter : profile.parameters) look_at(parameter.name_zh);
  if (objects)
    for (const auto& object : profile.dictionary.objects())
      for (const auto& entry : object.entries) look_at(entry.name_zh);
  if (objects)
    for (const auto& target : named_in_part(profile, text))
      add(target.parameter != nullptr ? numbered_name(*target.parameter) : written_name(profile, target));
  else
    for (const auto* parameter : parameters_named(profile, text, Match::part)) add(numbered_name(*parameter));
  return near.empty() ? Message() : message("did you mean {}?", one_of(near));
}

Message near_words(const Profile& profile, std::string_view text) {
  std::set<std::string> words;
  for (const auto& object : profile.dictionary.objects())
    for (const auto& entry : object.entries)
      for (auto& word : key_words(entry.name)) words.insert(std::move(word));
  const auto near = nearest(lower(text), std::vector(words.begin(), words.end()));
  return near.empty() ? Message() : near_names(profile, near.front(), true);
}

std::string numbered_name(const od::Parameter& parameter) { return parameter.id + " " + parameter.name; }

std::string written_name(const Profile& profile, const Target& target) {
  if (target.parameter != nullptr) return target.parameter->id;
  const auto* object = profile.dictionary.object(target.address.index);
  return object != nullptr && target.entry != nullptr ? entry_name(*object, *target.entry)
                                                      : to_string(target.address);
}

}  // namespace servoctl::drive
