#include "session/wary.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/access_alarms.hpp"
#include "drive/shared_profile.hpp"
#include "session/answer.hpp"
#include "session/family_check.hpp"
#include "session/option_scope.hpp"

namespace servoctl::session {

void consider_numbers(Session& session, const Identity& numbers) {
  const auto& where = session.options().drive_folders;
  std::shared_ptr<const drive::Profile> found;
  if (where && !numbers.by_registers) {
    const auto folders = where();
    for (const auto& family : drive::find_families(folders)) {
      const auto rules = drive::alarm_rules(family);
      if (rules == nullptr || !agrees_in_numbers(numbers, *rules)) continue;
      if (auto profile = drive::shared_profile(family.name, folders)) found = std::move(*profile);
    }
  }
  session.be_wary(numbers, std::move(found));
}

void consider_numbers(Session& session, std::span<const std::uint8_t> nodes) {
  std::vector<SdoRequest> requests;
  for (const auto node : nodes)
    if (!session.is_considered(node))
      for (const auto object : kDecidingNumbers) requests.push_back({node, object, {}});
  if (requests.empty() || !session.options().drive_folders) return;
  const OptionScope once(session, &Options::retries, 0U);
  const auto answers = session.transfer(requests);
  for (std::size_t i = 0; i + kDecidingNumbers.size() <= answers.size(); i += kDecidingNumbers.size()) {
    Identity numbers;
    numbers.node = requests[i].node;
    numbers.device_type = u32_in(answers[i]);
    numbers.vendor_id = u32_in(answers[i + 1]);
    numbers.product_code = u32_in(answers[i + 2]);
    if (numbers.device_type || numbers.vendor_id || numbers.product_code) consider_numbers(session, numbers);
  }
}

namespace {

/// Whether the object is one that a drive of some family does not have, and takes for an alarm.
bool could_raise(Session& session, ObjectAddress object) {
  if (std::ranges::find(kDecidingNumbers, object) != kDecidingNumbers.end() || drive::stops_a_drive(object) ||
      session.harmless().contains(object))
    return false;
  const auto folders = session.options().drive_folders();
  for (const auto& family : drive::find_families(folders)) {
    if (drive::alarm_rules(family) == nullptr) continue;
    const auto profile = drive::shared_profile(family.name, folders);
    if (profile && !drive::possible_alarm(**profile, object).empty()) return true;
  }
  session.harmless().insert(object);
  return false;
}

}  // namespace

void consider_before(Session& session, std::span<const SdoRequest> requests) {
  if (!session.options().drive_folders || session.modbus() != nullptr) return;
  std::vector<std::uint8_t> nodes;
  for (const auto& request : requests) {
    const auto node = request.node;
    if (session.is_considered(node) || session.wary_of(node) != nullptr ||
        std::ranges::find(nodes, node) != nodes.end())
      continue;
    if (could_raise(session, request.object)) nodes.push_back(node);
  }
  consider_numbers(session, nodes);
}

namespace {

/// The user's own file says what this drive has, and may know more objects than the family's data; the alarms
/// stay those of the family that the drive's numbers tell, if the file names none.
void be_wary_by_file(Session& session, std::uint8_t node, const drive::Profile& profile) {
  auto own = std::make_shared<drive::Profile>(profile);
  auto& fault = own->rules.fault;
  if (const auto* known = session.wary_of(node); known != nullptr && !drive::has_access_alarms(own->rules)) {
    fault.object_alarm = known->rules.fault.object_alarm;
    fault.sub_index_alarm = known->rules.fault.sub_index_alarm;
  }
  if (drive::has_access_alarms(own->rules)) session.be_wary(node, std::move(own));
}

}  // namespace

void be_wary_of_family(Session& session, std::uint8_t node, const drive::Profile& profile) {
  const auto& where = session.options().drive_folders;
  if (profile.of_file && !profile.dictionary.empty()) return be_wary_by_file(session, node, profile);
  if (!where || !drive::has_access_alarms(profile.rules)) return;
  if (auto shared = drive::shared_profile(profile.family, where())) session.be_wary(node, std::move(*shared));
}

std::string_view access_alarm(const Session& session, std::uint8_t node, ObjectAddress object) {
  const auto* profile = session.wary_of(node);
  return profile == nullptr ? std::string_view() : drive::access_alarm(*profile, object);
}

std::optional<Error> refusal_of(const Session& session, std::uint8_t node, ObjectAddress object) {
  const auto alarm = access_alarm(session, node, object);
  if (alarm.empty()) return std::nullopt;
  const auto& profile = *session.wary_of(node);
  auto error = drive_error(
      Errc::sdo_abort, node, object,
      message("not sent: the data of {} have no such object, and a request for it raises the alarm {}",
              as_it_is(profile.family), alarm),
      message("`objects -d {}` lists the objects of this family", as_it_is(profile.family)));
  const bool has_index = profile.dictionary.object(object.index) != nullptr;
  error.abort_code = has_index ? canopen::sdo_abort::kNoSubIndex : canopen::sdo_abort::kNoObject;
  return error;
}

}  // namespace servoctl::session
