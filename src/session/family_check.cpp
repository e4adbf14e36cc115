#include "session/family_check.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/shared_profile.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::session {
namespace {

using drive::IdentityMark;

enum class Says : std::uint8_t { nothing, yes, no };

std::optional<std::uint32_t> number_of(const Identity& identity, ObjectAddress object) {
  if (object == objects::kDeviceType) return identity.device_type;
  if (object == objects::kVendorId) return identity.vendor_id;
  if (object == objects::kProductCode) return identity.product_code;
  if (object == objects::kRevision) return identity.revision;
  if (object == objects::kSerialNumber) return identity.serial;
  return std::nullopt;
}

Says ask(const Identity& identity, const IdentityMark& mark) {
  if (!mark.text.empty()) {
    if (mark.object != objects::kDeviceName || identity.device_name.empty()) return Says::nothing;
    return trim(identity.device_name) == mark.text ? Says::yes : Says::no;
  }
  const auto number = number_of(identity, mark.object);
  if (!number) return Says::nothing;
  return (*number & mark.mask) == (mark.value & mark.mask) ? Says::yes : Says::no;
}

std::string drive_says(const Identity& identity, const IdentityMark& mark) {
  if (!mark.text.empty()) return formatted("\"{}\"", trim(identity.device_name));
  return formatted("0x{:08X}", number_of(identity, mark.object).value_or(0));
}

std::string family_says(const IdentityMark& mark) {
  if (!mark.text.empty()) return formatted("\"{}\"", mark.text);
  const auto value = formatted("0x{:08X}", mark.value);
  return mark.mask == ~std::uint64_t{0} ? value : formatted("{} in the bits 0x{:08X}", value, mark.mask);
}

/// Whether the family's own objects are there: all of them, none, or not known.
Says own_objects(const Identity& identity, const drive::Rules& rules) {
  std::size_t there = 0;
  std::size_t away = 0;
  for (const auto object : rules.identity_looks) {
    const auto looked = identity.looked.find(object);
    if (looked == identity.looked.end()) return Says::nothing;
    ++(looked->second ? there : away);
  }
  if (there > 0 && away > 0) return Says::nothing;
  return there > 0 ? Says::yes : away > 0 ? Says::no : Says::nothing;
}

std::string names(std::span<const ObjectAddress> objects) {
  std::string out;
  for (const auto object : objects) append(out, to_string(object));
  return out;
}

bool is_telling(const drive::Rules& rules) { return rules.identity_telling || rules.identity_certain; }

/// What is not so, of the family's own marks; soft ones count when they are asked for.
const IdentityMark* violated(const Identity& identity, const drive::Rules& rules, bool soft) {
  for (const auto& mark : rules.identity)
    if (mark.soft == soft && ask(identity, mark) == Says::no) return &mark;
  return nullptr;
}

std::string held(const Identity& identity, const drive::Rules& rules) {
  std::string out;
  for (const auto& mark : rules.identity)
    append(out, formatted("{} = {}", to_string(mark.object), drive_says(identity, mark)));
  return out;
}

/// What is missing for a proof; `soft` is a mark that is not so, or null.
std::string why_unproven(const Identity& identity, const drive::Profile& profile, const IdentityMark* soft) {
  const auto& rules = profile.rules;
  if (soft != nullptr)
    return formatted("its {} is {}, but {} has {}", to_string(soft->object), drive_says(identity, *soft),
                     profile.family, family_says(*soft));
  if (rules.identity.empty()) return formatted("{} has no known identity", profile.family);
  if (fits(identity, rules)) return formatted("{} matches, but not uniquely", held(identity, rules));
  return formatted("it does not report all that {} would", profile.family);
}

/// The other family that the drive tells it is, where the one that was named says nothing against it.
void judge_by_others(const Identity& identity, const drive::Profile& profile,
                     std::span<const drive::Family> families, FamilyVerdict& verdict) {
  if (profile.of_file) return;
  for (const auto& family : families) {
    if (profile.descends_from(family.name)) continue;
    const auto shared = drive::shared_rules(family);
    if (!shared) continue;
    const auto& rules = **shared;
    if (!is_telling(rules) || !may_be(identity, rules)) continue;
    verdict.kind = FamilyVerdict::Kind::contradicted;
    verdict.object = rules.identity.front().object;
    verdict.why = formatted("its identity is that of {} ({})", family.name, held(identity, rules));
    return;
  }
}

}  // namespace

bool fits(const Identity& identity, const drive::Rules& rules) {
  return std::all_of(rules.identity.begin(), rules.identity.end(),
                     [&](const IdentityMark& mark) { return ask(identity, mark) == Says::yes; });
}

bool agrees_in_numbers(const Identity& identity, const drive::Rules& rules) {
  const auto says = [&](Says answer) {
    return std::any_of(rules.identity.begin(), rules.identity.end(),
                       [&](const IdentityMark& mark) { return ask(identity, mark) == answer; });
  };
  return says(Says::yes) && !says(Says::no);
}

bool has_marks(const drive::Rules& rules) {
  return std::any_of(rules.identity.begin(), rules.identity.end(),
                     [](const IdentityMark& mark) { return !mark.soft; });
}

bool may_be(const Identity& identity, const drive::Rules& rules) {
  if (!fits(identity, rules)) return false;
  const auto own = own_objects(identity, rules);
  return own == Says::yes || (own == Says::nothing && has_marks(rules));
}

bool fits_as_generic(const Identity& identity, const drive::Rules& rules) {
  return !rules.identity.empty() && !has_marks(rules) && fits(identity, rules);
}

FamilyVerdict judge_family(const Identity& identity, const drive::Profile& profile,
                           std::span<const drive::Family> families) {
  const auto& rules = profile.rules;
  FamilyVerdict out;
  if (const auto* mark = violated(identity, rules, false)) {
    out.kind = FamilyVerdict::Kind::contradicted;
    out.object = mark->object;
    out.why = formatted("its {} is {}, but {} has {}", to_string(mark->object), drive_says(identity, *mark),
                        profile.family, family_says(*mark));
    return out;
  }
  if (own_objects(identity, rules) == Says::no) {
    out.kind = FamilyVerdict::Kind::contradicted;
    out.object = rules.identity_looks.front();
    out.why =
        formatted("it refuses to read {}, which every {} has", names(rules.identity_looks), profile.family);
    return out;
  }
  if (identity.by_registers) {
    out.why = "registers do not say what a device is";
    return out;
  }
  const auto* soft = violated(identity, rules, true);
  const bool has_own = own_objects(identity, rules) == Says::yes;
  const bool tells = has_own || (is_telling(rules) && !rules.identity.empty());
  if (tells && soft == nullptr && fits(identity, rules)) {
    out.kind = FamilyVerdict::Kind::proven;
    return out;
  }
  judge_by_others(identity, profile, families, out);
  if (out.kind == FamilyVerdict::Kind::contradicted) return out;
  out.why = why_unproven(identity, profile, soft);
  return out;
}

}  // namespace servoctl::session
