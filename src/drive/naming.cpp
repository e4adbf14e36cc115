#include "drive/naming.hpp"

#include <algorithm>

#include "base/folded.hpp"
#include "base/format.hpp"
#include "base/text.hpp"

namespace servoctl::drive {
namespace {

bool is_plain(const od::Object& object) {
  return object.entries.size() == 1 && object.entries.front().address.sub == 0;
}

/// Entries of `object` that `part` names: exactly, or as a piece of one name.
std::vector<const od::Entry*> entries_named(const od::Object& object, std::string_view part) {
  std::vector<const od::Entry*> pieces;
  for (const auto& entry : object.entries) {
    const auto name = od::identifier(entry.name);
    if (name == part) return {&entry};
    if (entry.address.sub != 0 && !part.empty() && name.find(part) != std::string::npos)
      pieces.push_back(&entry);
  }
  return pieces;
}

/// Whether it can be an English name: od::identifier() leaves out all else, and would find another object.
bool is_ascii(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

/// What the names for Chinese readers are compared by; some of them have no Chinese in them (`RPDO1 COB-ID`).
std::string chinese_key(std::string_view text) {
  auto out = folded(text);
  std::erase(out, ' ');
  return out;
}

/// What is called so in part, or a part of what was written, as a question; empty where nothing is.
std::string near_in_chinese(const Profile& profile, std::string_view text, bool objects) {
  constexpr std::size_t kMost = 3;
  const auto wanted = chinese_key(text);
  std::vector<std::string> near;
  const auto look_at = [&](const std::string& name) {
    const auto key = chinese_key(name);
    const bool is_near = !key.empty() && (key.find(wanted) != std::string::npos || wanted.starts_with(key));
    if (is_near && near.size() < kMost && std::find(near.begin(), near.end(), name) == near.end())
      near.push_back(name);
  };
  if (wanted.empty()) return {};
  for (const auto& parameter : profile.parameters) look_at(parameter.name_zh);
  if (objects)
    for (const auto& object : profile.dictionary.objects())
      for (const auto& entry : object.entries) look_at(entry.name_zh);
  return near.empty() ? std::string() : formatted("did you mean {}?", one_of(near));
}

tl::unexpected<Error> unknown(const Profile& profile, std::string_view text) {
  const auto known = names(profile);
  auto hint = is_ascii(text) ? did_you_mean(lower(text), known) : near_in_chinese(profile, text, true);
  if (hint.empty())
    hint = profile.parameters.empty()
               ? "`objects PATTERN` finds names; an index is written 0x6041 or 6041h"
               : "`objects PATTERN` and `param search WORD` find names; an index is written 0x6041 or 6041h";
  return fail(Errc::usage, formatted("'{}' is not an object or parameter of {}", text, profile.family),
              std::move(hint));
}

tl::unexpected<Error> ambiguous(std::string_view text, const std::vector<std::string>& meanings) {
  const std::vector<std::string> shown(
      meanings.begin(),
      meanings.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(meanings.size(), 6)));
  return fail(Errc::usage, formatted("'{}' is ambiguous: {} meanings", text, meanings.size()),
              "write " + one_of(shown) + (shown.size() < meanings.size() ? ", …" : ""));
}

/// Objects and entries by name; empty when nothing of this name exists.
std::vector<Target> named(const Profile& profile, std::string_view text) {
  const auto dot = text.find('.');
  const auto object_name = od::identifier(text.substr(0, dot));
  const auto part = dot == std::string_view::npos ? std::string() : od::identifier(text.substr(dot + 1));
  std::vector<Target> out;
  if (object_name.empty()) return out;
  for (const auto& object : profile.dictionary.objects()) {
    if (od::identifier(object.name) != object_name) continue;
    if (dot == std::string_view::npos) {
      for (const auto& entry : object.entries)
        if (is_plain(object) || entry.address.sub != 0) out.push_back(target_at(&profile, entry.address));
    } else {
      for (const auto* entry : entries_named(object, part))
        out.push_back(target_at(&profile, entry->address));
    }
  }
  return out;
}

void add_once(std::vector<Target>& targets, const Profile& profile, ObjectAddress address) {
  if (std::none_of(targets.begin(), targets.end(), [&](const Target& t) { return t.address == address; }))
    targets.push_back(target_at(&profile, address));
}

/// Parameters and entries that are called so for Chinese readers.
std::vector<Target> named_in_chinese(const Profile& profile, std::string_view text) {
  const auto wanted = chinese_key(text);
  std::vector<Target> out;
  if (wanted.empty()) return out;
  for (const auto& parameter : profile.parameters)
    if (parameter.object && chinese_key(parameter.name_zh) == wanted)
      add_once(out, profile, *parameter.object);
  for (const auto& object : profile.dictionary.objects())
    for (const auto& entry : object.entries)
      if (chinese_key(entry.name_zh) == wanted) add_once(out, profile, entry.address);
  return out;
}

/// Objects by their English names, else parameters.
std::vector<Target> named_in_english(const Profile& profile, std::string_view text) {
  if (!is_ascii(text)) return {};
  auto out = named(profile, text);
  if (!out.empty()) return out;
  const auto wanted = od::identifier(text);
  for (const auto& parameter : profile.parameters)
    if (parameter.object && od::identifier(parameter.name) == wanted)
      out.push_back(target_at(&profile, *parameter.object));
  return out;
}

/// Parameters that are called so, in English or for Chinese readers.
std::vector<const od::Parameter*> parameters_named(const Profile& profile, std::string_view text) {
  std::vector<const od::Parameter*> out;
  const auto wanted = is_ascii(text) ? od::identifier(text) : std::string();
  for (const auto& parameter : profile.parameters)
    if (!wanted.empty() && od::identifier(parameter.name) == wanted) out.push_back(&parameter);
  if (!out.empty()) return out;
  const auto chinese = chinese_key(text);
  for (const auto& parameter : profile.parameters)
    if (!chinese.empty() && chinese_key(parameter.name_zh) == chinese) out.push_back(&parameter);
  return out;
}

tl::unexpected<Error> without_object(const od::Parameter& parameter) {
  return fail(Errc::usage, formatted("{} has no CANopen object", parameter.id + " " + parameter.name),
              "it can be changed only on the panel; `param explain` describes it");
}

std::string full_name(const Profile& profile, const Target& target) {
  if (target.parameter != nullptr) return target.parameter->id;
  const auto* object = profile.dictionary.object(target.address.index);
  return object != nullptr && target.entry != nullptr ? entry_name(*object, *target.entry)
                                                      : to_string(target.address);
}

/// A number that only the family's rule knows.
std::optional<Target> by_rule(const Profile& profile, std::string_view text) {
  if (profile.parameter(text) != nullptr) return std::nullopt;
  for (const auto& rule : profile.rules.numbering) {
    const auto number = rule.unlisted ? rule.number(text) : std::nullopt;
    if (!number) continue;
    auto target = target_at(&profile, rule.object(*number));
    if (target.parameter != nullptr) return target;
    target.unlisted = rule.prefix + std::string(text.substr(rule.prefix.size()));
    target.read_only = rule.read_only;
    return target;
  }
  return std::nullopt;
}

}  // namespace

std::string Target::label() const {
  if (parameter != nullptr) return parameter->id + " " + parameter->name;
  if (!unlisted.empty()) return unlisted;
  return entry != nullptr ? entry->name : std::string();
}

bool Target::is_contradicted(std::string_view field) const {
  if (parameter == nullptr) return false;
  const auto& marks = parameter->doubts.contradicted;
  return std::any_of(marks.begin(), marks.end(), [&](const od::Mark& mark) { return mark.field == field; });
}

std::string Target::label_zh() const {
  if (parameter != nullptr && !parameter->name_zh.empty()) return parameter->id + " " + parameter->name_zh;
  return entry != nullptr && !entry->name_zh.empty() ? entry->name_zh : label();
}

namespace {

/// Panel numbers tell the place themselves.
std::string placed(const Target& target, std::string label) {
  if (target.parameter != nullptr || !target.unlisted.empty()) return label;
  const auto where = to_string(target.address);
  return label.empty() ? where : where + " " + label;
}

}  // namespace

std::string Target::in_sentence() const { return placed(*this, label()); }

std::string Target::in_sentence_zh() const { return placed(*this, label_zh()); }

Target target_at(const Profile* profile, ObjectAddress address) {
  Target out;
  out.address = address;
  if (profile == nullptr) return out;
  out.entry = profile->dictionary.find(address);
  out.parameter = profile->parameter(address);
  return out;
}

std::string entry_name(const od::Object& object, const od::Entry& entry) {
  const auto name = od::identifier(object.name);
  return is_plain(object) ? name : name + "." + od::identifier(entry.name);
}

std::optional<ObjectAddress> place_of(const Profile& profile, std::string_view name) {
  if (name.empty()) return std::nullopt;
  const auto target = resolve(&profile, name);
  return target ? std::optional(target->address) : std::nullopt;
}

std::vector<std::string> names(const Profile& profile) {
  std::vector<std::string> out;
  for (const auto& parameter : profile.parameters) out.push_back(parameter.id);
  for (const auto& object : profile.dictionary.objects())
    for (const auto& entry : object.entries)
      if (profile.parameter(entry.address) == nullptr) out.push_back(entry_name(object, entry));
  return out;
}

Result<const od::Parameter*> resolve_parameter(const Profile& profile, std::string_view text) {
  if (const auto* parameter = profile.parameter(text)) return parameter;
  if (const auto address = parse_object_address(text))
    if (const auto* parameter = profile.parameter(*address)) return parameter;
  const auto named = parameters_named(profile, text);
  if (named.size() == 1) return named.front();
  std::vector<std::string> known;
  for (const auto* parameter : named) known.push_back(parameter->id);
  if (named.size() > 1) return ambiguous(text, known);
  for (const auto& parameter : profile.parameters) known.push_back(parameter.id);
  auto hint = profile.parameters.empty() ? formatted("{} has no panel parameter table", profile.family)
              : is_ascii(text)           ? did_you_mean(text, known)
                                         : near_in_chinese(profile, text, false);
  if (hint.empty())
    hint = formatted("`param list -d {0}` shows all, `param search WORD -d {0}` finds them by name",
                     profile.family);
  return fail(Errc::usage, formatted("'{}' is not a panel parameter of {}", text, profile.family),
              std::move(hint));
}

Result<Target> resolve_panel(const Profile& profile, std::string_view text) {
  if (auto target = by_rule(profile, text)) return *target;
  const auto parameter = resolve_parameter(profile, text);
  if (!parameter) return fail(parameter.error());
  return resolve(&profile, (*parameter)->id);
}

Result<Target> resolve(const Profile* profile, std::string_view text) {
  if (const auto address = parse_object_address(text)) return target_at(profile, *address);
  if (profile == nullptr)
    return fail(Errc::usage, formatted("'{}' is not an object address, and names need a drive family", text),
                "write an address such as 0x6041 or 0x6099:1, or add -d FAMILY (`drives` lists them)");
  if (const auto* parameter = profile->parameter(text)) {
    if (!parameter->object) return without_object(*parameter);
    return target_at(profile, *parameter->object);
  }
  if (auto target = by_rule(*profile, text)) return *target;
  auto found = named_in_english(*profile, text);
  if (found.empty()) found = named_in_chinese(*profile, text);
  if (found.empty()) {
    const auto named = parameters_named(*profile, text);
    return named.empty() ? unknown(*profile, text) : without_object(*named.front());
  }
  if (found.size() == 1) return found.front();
  std::vector<std::string> meanings;
  for (const auto& target : found) meanings.push_back(full_name(*profile, target));
  return ambiguous(text, meanings);
}

}  // namespace servoctl::drive
