#include "settings/energising.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/enabling_write.hpp"
#include "drive/standard_objects.hpp"
#include "session/cob_id_check.hpp"
#include "settings/register_writes.hpp"

namespace servoctl::settings {
namespace {

constexpr std::string_view kOtherWay =
    "run servoctl where the bus is, or use its CAN interface: socketcand://HOST/can0";

bool is_parameter(const drive::Profile& profile, const Change& change, const std::string& id) {
  return drive::place_of(profile, id) == change.target.address;
}

/// Which objects of a manufacturer energise a motor says only the data of its family.
bool may_be_power(const drive::Profile* profile, ObjectAddress object, ByteSpan data) {
  const bool vendor_object = object.index >= 0x2000 && object.index < 0x6000;
  return profile == nullptr && vendor_object && load_le(data) != 0;
}

/// Where a network gives a motor no power: Errc::refused for what energises one without the controlword.
Result<void> check_power(const show::Desk& desk, std::uint8_t node, ObjectAddress object, const Bytes& data) {
  const auto no_power = desk.session->network().why_no_power();
  if (no_power.empty()) return {};
  if (may_be_power(desk.profile, object, data))
    return fail(drive_error(
        Errc::refused, node, object,
        message("without its family it is not known whether this energises the motor, and {}", no_power),
        "name the family: -d FAMILY"));
  if (drive::power_parameter(desk.profile, object, data) == nullptr) return {};
  return fail(drive_error(
      Errc::refused, node, object,
      message("this energises the motor, or sets it in motion, without the controlword, and {}", no_power),
      std::string(kOtherWay)));
}

/// Those that energise among values that a drive does not hold yet.
std::vector<std::pair<ObjectAddress, const drive::PowerParameter*>> power_values(
    const show::Desk& desk, const session::Values& present, const session::Values& wanted) {
  std::vector<std::pair<ObjectAddress, const drive::PowerParameter*>> out;
  for (const auto& [object, data] : wanted) {
    const auto now = present.find(object);
    if (now != present.end() && now->second == data) continue;
    if (const auto* parameter = drive::power_parameter(desk.profile, object, data))
      out.emplace_back(object, parameter);
  }
  return out;
}

void tell_power(show::Desk& desk, std::uint8_t node, const drive::PowerParameter& parameter) {
  desk.notices.push_back(message(
      "node {}: its motor may get power or move without the controlword, and servoctl neither supervises nor "
      "stops it: `param set {}={} -n {}`",
      node_name(node), as_it_is(parameter.end), as_it_is(parameter.value), node_name(node)));
}

}  // namespace

std::string_view reason_to_ask(const show::Desk& desk, const Change& change) {
  const auto* profile = desk.profile;
  const auto* entry = change.target.entry;
  const auto* parameter = change.target.parameter;
  const auto index = change.target.address.index;
  if (profile != nullptr && is_parameter(*profile, change, profile->rules.store.unlock)) return {};
  if (enables(change)) return "This enables the drive: the motor is energised and may move.";
  if (power_parameter(desk, change) != nullptr)
    return drive::meaning(change.target, change.node).effect == od::Effect::restart
               ? "After a restart of the drive this may energise the motor without the controlword."
               : "This may energise the motor, or set it in motion, without the controlword; `disable` may not "
                 "stop it.";
  if (index == objects::kStoreIndex || index == objects::kRestoreIndex ||
      (entry != nullptr && entry->command) || (parameter != nullptr && parameter->command))
    return "This starts an action, or stores or restores parameters.";
  if (profile != nullptr && is_parameter(*profile, change, profile->rules.nmt.node_id))
    return "After a restart the drive has another node-ID.";
  if (profile != nullptr && is_parameter(*profile, change, profile->rules.nmt.bitrate))
    return "After a restart the drive has another bitrate.";
  return {};
}

bool enables(const Change& change) { return drive::is_enabling_write(change.target.address, change.data); }

const drive::PowerParameter* power_parameter(const show::Desk& desk, const Change& change) {
  return drive::power_parameter(desk.profile, change.target.address, change.data);
}

Result<void> check_writable(const show::Desk& desk, std::uint8_t node, ObjectAddress object,
                            const Bytes& data) {
  if (const auto free = session::check_cob_id(desk.profile, object, data, node); !free) return free;
  return check_power(desk, node, object, data);
}

Result<void> confirm_changes(show::Desk& desk, std::span<const Change> changes) {
  const auto no_power = desk.session->network().why_no_power();
  for (const auto& change : changes) {
    if (!no_power.empty() && enables(change))
      return fail(show::located(make_error(Errc::refused, message("this enables the drive, and {}", no_power),
                                           std::string(kOtherWay)),
                                change.node, change.target.address));
    if (const auto possible = check_power(desk, change.node, change.target.address, change.data); !possible)
      return possible;
  }
  for (const auto& change : changes) {
    auto reason = reason_to_ask(desk, change);
    if (reason.empty()) reason = register_reason(desk, change);
    if (reason.empty()) continue;
    const auto question =
        formatted("Write {} on node {}? {}", change.target.in_sentence(), change.node, reason);
    if (const auto answer = desk.confirm(question); !answer) return answer;
  }
  return {};
}

void tell_power_parameters(show::Desk& desk, std::span<const Change> changes,
                           std::span<const Result<session::Written>> written) {
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const auto& change = changes[i];
    const auto* parameter = power_parameter(desk, change);
    if (parameter == nullptr || is_told_not_at_rest(desk, change.target.address) ||
        session::write_end(written[i], change.target.address) == session::WriteEnd::not_written)
      continue;
    tell_power(desk, change.node, *parameter);
  }
}

std::string power_question(const show::Desk& desk, std::uint8_t node, const session::Values& present,
                           const session::Values& wanted) {
  std::string at_once, after_restart;
  for (const auto& [object, parameter] : power_values(desk, present, wanted)) {
    const auto target = drive::target_at(desk.profile, object);
    const bool waits = drive::meaning(target, node).effect == od::Effect::restart;
    append(waits ? after_restart : at_once, target.in_sentence());
  }
  std::string out;
  if (!at_once.empty())
    out += formatted(
        " Without the controlword the motor may be energised, or set in motion, by {}; `disable` may not stop it.",
        at_once);
  if (!after_restart.empty())
    out +=
        formatted(" Without the controlword the motor may be energised after a restart of the drive by {}.",
                  after_restart);
  return out;
}

void tell_power_values(show::Desk& desk, std::uint8_t node, const session::Values& present,
                       const session::Values& wanted) {
  for (const auto& value : power_values(desk, present, wanted)) tell_power(desk, node, *value.second);
}

}  // namespace servoctl::settings
