#include "pdo/other_pdo.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"

namespace servoctl::pdo {
namespace {

using canopen::Pdo;

/// As far as the dictionary tells.
bool may_be_mapped(const drive::Profile& profile, const Pdo& pdo) {
  const auto* count = profile.dictionary.find({pdo.mapping_index(), 0});
  return count == nullptr || od::writable(count->access);
}

const Pdo* other_pdo(const drive::Profile& profile, const PresentPdos& present, const Pdo& fixed) {
  const Pdo* out = nullptr;
  for (const auto& pdo : present.pdos) {
    if (pdo.direction != fixed.direction || pdo.number == fixed.number || !may_be_mapped(profile, pdo))
      continue;
    if (out == nullptr || (out->is_valid() && !pdo.is_valid())) out = &pdo;
  }
  return out;
}

}  // namespace

std::string other_pdo_hint(const drive::Profile& profile, const PresentPdos& present,
                           const WantedPdos& wanted, const Error& failure) {
  const auto place = canopen::pdo_at(failure.object.value_or(ObjectAddress{}).index);
  if (!place || !place->mapping || failure.abort_code != canopen::sdo_abort::kReadOnly) return {};
  const Pdo fixed{place->direction, place->number};
  const auto found = std::find_if(wanted.pdos.begin(), wanted.pdos.end(),
                                  [&](const Pdo& pdo) { return same_pdo(pdo, fixed); });
  const auto* other = other_pdo(profile, present, fixed);
  if (found == wanted.pdos.end() || other == nullptr) return {};
  std::string words;
  for (const auto& entry : found->entries)
    words += entry.is_gap() ? formatted(" gap{}", entry.bits)
                            : formatted(" {}/{}", to_string(entry.object), entry.bits);
  return formatted("the drive fixes what {} carries; try another PDO: `pdo map {}{} -n {}`",
                   canopen::name(fixed.direction, fixed.number),
                   canopen::name(other->direction, other->number), words, present.node);
}

}  // namespace servoctl::pdo
