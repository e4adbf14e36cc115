#include "drive/naming.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "drive/maker_parameters.hpp"
#include "drive/name_key.hpp"
#include "drive/named.hpp"

namespace servoctl::drive {
namespace {

/// Whether it can be an English name, which is near another one by its letters.
bool is_ascii(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

tl::unexpected<Error> unknown(const Profile& profile, std::string_view text) {
  auto hint = near_names(profile, text, true);
  if (hint.empty() && is_ascii(text)) hint = did_you_mean(lower(text), names(profile));
  if (hint.empty()) hint = near_words(profile, text);
  if (hint.empty())
    hint = profile.parameters.empty()
               ? "`objects PATTERN` finds names; an index is written 0x6041 or 6041h"
               : "`objects PATTERN` and `param search WORD` find names; an index is written 0x6041 or 6041h";
  return fail(Errc::usage,
              message("'{}' is not an object or parameter of {}", as_it_is(text), as_it_is(profile.family)),
              std::move(hint));
}

tl::unexpected<Error> ambiguous(std::string_view text, const std::vector<std::string>& meanings) {
  const std::vector<std::string> shown(
      meanings.begin(),
      meanings.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(meanings.size(), 6)));
  return fail(Errc::usage, message("'{}' is ambiguous: {} meanings", as_it_is(text), meanings.size()),
              shown.size() < meanings.size() ? message("write {}, …", NameList{shown})
                                             : message("write {}", one_of(shown)));
}

tl::unexpected<Error> without_object(const od::Parameter& parameter) {
  return fail(Errc::usage, message("{} has no CANopen object", parameter.id + " " + parameter.name),
              "it can be changed only on the panel; `param explain` describes it");
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
  const bool is_plain = object.entries.size() == 1 && object.entries.front().address.sub == 0;
  const auto name = name_key(object.name);
  return is_plain ? name : name + "." + name_key(entry.name);
}

std::optional<ObjectAddress> place_of(const Profile& profile, std::string_view name) {
  if (name.empty()) return std::nullopt;
  const auto target = resolve(&profile, name);
  return target ? std::optional(target->address) : std::nullopt;
}

std::vector<std::string> names(const Profile& profile) {
  std::vector<std::string> out;
  for (const auto& parameter : profile.parameters)
    if (!parameter.placed) out.push_back(parameter.id);
  for (const auto& object : profile.dictionary.objects())
    for (const auto& entry : object.entries)
      if (profile.parameter(entry.address) == nullptr) out.push_back(entry_name(object, entry));
  return out;
}

Result<const od::Parameter*> resolve_parameter(const Profile& profile, std::string_view text, Match match) {
  if (const auto* parameter = profile.parameter(text)) return parameter;
  if (const auto address = parse_object_address(text))
    if (const auto* parameter = profile.parameter(*address)) return parameter;
  if (const auto address = parse_object_address(text))
    if (const auto* placed = profile.parameter(to_string(*address))) return placed;
  const auto named = parameters_named(profile, text, match);
  if (named.size() == 1) return named.front();
  std::vector<std::string> known;
  for (const auto* parameter : named) known.push_back(numbered_name(*parameter));
  if (named.size() > 1) return ambiguous(text, known);
  for (const auto& parameter : profile.parameters) known.push_back(parameter.id);
  auto hint = known.empty() ? message("{} has no parameters", as_it_is(profile.family))
                            : Message(near_names(profile, text, false));
  if (hint.empty() && is_ascii(text)) hint = did_you_mean(text, known);
  if (hint.empty())
    hint = message("`param list -d {0}` shows all, `param search WORD -d {0}` finds them by name",
                   as_it_is(profile.family));
  return fail(Errc::usage,
              message("'{}' is not a panel parameter of {}", as_it_is(text), as_it_is(profile.family)),
              std::move(hint));
}

Result<Target> resolve_panel(const Profile& profile, std::string_view text, Match match) {
  if (auto target = by_rule(profile, text)) return *target;
  const auto parameter = resolve_parameter(profile, text, match);
  if (!parameter) return fail(parameter.error());
  if (!(*parameter)->object) return without_object(**parameter);
  return target_at(&profile, *(*parameter)->object);
}

namespace {

/// `A001` may be a maker's number and the address of an object: it is what there is, and both are one too
/// many.
Result<Target> at_address(const Profile* profile, ObjectAddress address, std::string_view text) {
  const auto* numbered = profile == nullptr ? nullptr : profile->parameter(text);
  if (numbered == nullptr || numbered->placed || !numbered->object || *numbered->object == address)
    return target_at(profile, address);
  if (profile->dictionary.object(address.index) == nullptr) return target_at(profile, *numbered->object);
  return ambiguous(text, {to_string(address), to_string(*numbered->object)});
}

}  // namespace

Result<Target> resolve(const Profile* profile, std::string_view text, Match match) {
  if (const auto address = parse_object_address(text)) return at_address(profile, *address, text);
  if (profile == nullptr)
    return fail(Errc::usage,
                message("'{}' is not an object address, and names need a drive family", as_it_is(text)),
                "write an address such as 0x6041 or 0x6099:1, or add -d FAMILY (`drives` lists them)");
  if (const auto* parameter = profile->parameter(text)) {
    if (!parameter->object) return without_object(*parameter);
    return target_at(profile, *parameter->object);
  }
  if (auto target = by_rule(*profile, text)) return *target;
  auto found = named_wholly(*profile, text, match);
  if (found.empty())
    if (const auto named = parameters_named(*profile, text, Match::whole); !named.empty())
      return without_object(*named.front());
  if (found.empty() && match == Match::part && !looks_like_number(text))
    found = named_in_part(*profile, text);
  if (found.empty()) return unknown(*profile, text);
  if (found.size() == 1) return found.front();
  std::vector<std::string> meanings;
  for (const auto& target : found) meanings.push_back(written_name(*profile, target));
  return ambiguous(text, meanings);
}

}  // namespace servoctl::drive
