#include "settings/restore_end.hpp"

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "settings/change.hpp"

namespace servoctl::settings {

RestoreEnd end_of(const session::RestoreOutcome& outcome) {
  if (!outcome.failure) return RestoreEnd::done;
  if (outcome.rolled_back)
    return outcome.in_flash.empty() ? RestoreEnd::rolled_back : RestoreEnd::flash_changed;
  if (outcome.all_written) return RestoreEnd::not_kept;
  return outcome.astray.empty() ? RestoreEnd::left : RestoreEnd::astray;
}

std::string_view failed_state(const session::RestoreOutcome& outcome) {
  switch (end_of(outcome)) {
    case RestoreEnd::rolled_back: return "failed; every value is as it was before";
    case RestoreEnd::flash_changed:
      return "failed; it works with its old values, but its flash may not be as it was; see the errors";
    case RestoreEnd::not_kept: return "written and read back; see the error";
    case RestoreEnd::left: return "failed; what was written stays written";
    default: return "failed; see the errors";
  }
}

Error flash_error(const drive::Profile* profile, std::uint8_t node,
                  const std::vector<ObjectAddress>& in_flash) {
  constexpr std::size_t kMostNamed = 6;
  std::string names;
  for (std::size_t i = 0; i < in_flash.size() && i < kMostNamed; ++i)
    append(names, drive::target_at(profile, in_flash[i]).in_sentence());
  if (in_flash.size() > kMostNamed) append(names, formatted("and {} more", in_flash.size() - kMostNamed));
  return drive_error(
      Errc::negative, node,
      message("its flash was not put back: after power-off these may have other values: {}", names),
      "it worked in RAM, so what its flash held before is not known");
}

std::vector<Error> errors_of(const session::RestoreOutcome& outcome, const drive::Profile* profile,
                             std::uint8_t node) {
  std::vector<Error> out;
  if (!outcome.failure) return out;
  out.push_back(*outcome.failure);
  for (const auto object : outcome.astray)
    out.push_back(drive_error(Errc::negative, node, object,
                              "it may hold neither the value that was to be written nor its old one"));
  const auto end = end_of(outcome);
  if (!outcome.in_flash.empty() && (end == RestoreEnd::flash_changed || end == RestoreEnd::astray))
    out.push_back(flash_error(profile, node, outcome.in_flash));
  return out;
}

bool is_refused_store(const Error& error) {
  return error.abort_code && error.object && error.object->index == objects::kStoreIndex;
}

}  // namespace servoctl::settings
