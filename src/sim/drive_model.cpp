// How a drive model starts and how time passes for it.
#include "sim/drive_model.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "canopen/node_id.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "od/value.hpp"

namespace servoctl::sim {
namespace {

/// CiA 402-2, table of error codes.
constexpr std::uint16_t kFollowingErrorFault = 0x8611;

}  // namespace

DriveModel::DriveModel(const drive::Profile& profile, std::uint8_t node, Memory& memory, std::string key)
    : profile_(&profile),
      memory_(&memory),
      key_(std::move(key)),
      node_(node),
      values_(profile),
      power_(profile.rules),
      axis_(profile, values_) {
  begin_memory(node);
}

void DriveModel::power_on(TimePoint now) {
  now_ = now;
  operational_ = false;
  load_values(true, now);
  begin_communication();
}

void DriveModel::reset_node(TimePoint now) {
  now_ = now;
  operational_ = false;
  load_values(profile_->rules.nmt.address_after != drive::NmtRules::Restart::power_cycle, now);
  begin_communication();
}

void DriveModel::reset_communication(TimePoint now) {
  now_ = now;
  load_communication_area();
  begin_communication();
}

/// What went wrong with the communication is over.
void DriveModel::begin_communication() {
  for (const auto source :
       {ErrorLog::Source::rpdo_short, ErrorLog::Source::rpdo_long, ErrorLog::Source::master})
    errors_.end(source);
  emergencies_.clear();
  values_.set_number(objects::kErrorRegister, errors_.error_register());
  if (serial_ && values_.has(objects::kSerialNumber)) values_.set_number(objects::kSerialNumber, *serial_);
  load_mirrors();
}

/// The values with which it starts: the defaults and what its memory has. Without power-on (`restarts` is
/// false), the values that only a restart changes stay.
void DriveModel::load_values(bool restarts, TimePoint now) {
  const auto load = [this] {
    values_.load_defaults(node_);
    for (const auto& cell : memory_->cells(key_)) values_.set(cell.first, cell.second);
  };
  if (restarts) restore_if_asked();
  load();
  if (const auto kept = kept_node(); restarts && kept && *kept != node_) {
    node_ = *kept;
    load();
  }
  if (restarts) values_.start();
  values_.release();
  ramps_down_ = false;
  power_.reset();
  axis_.reset(now);
  errors_ = {};
  errors_.set_capacity(values_.last_sub(objects::kErrorHistory.index));
  fault_ = nullptr;
}

/// 1000h to 1FFFh as they are after power-on: what was stored, else the defaults (CiA 301, 7.3.2.2.1).
void DriveModel::load_communication_area() {
  values_.load_communication_defaults(node_);
  for (const auto& cell : memory_->cells(key_))
    if (in_communication_area(cell.first.index)) values_.set(cell.first, cell.second);
}

void DriveModel::set_operational(bool operational) {
  const bool leaves = operational_ && !operational;
  if (leaves && profile_->rules.nmt.disables_outside_operational) power_.disable();
  operational_ = operational;
}

void DriveModel::take_interpolation_point() {
  move_axis();
  axis_.take_point();
}

void DriveModel::on_time(TimePoint now) {
  now_ = now;
  move_axis();
  power_.on_time(now);
  move_axis();
  if (!planned_fault_ || now < planned_fault_->time) return;
  const auto alarm = std::exchange(planned_fault_, std::nullopt)->alarm;
  raise_fault(alarm.code, alarm.vendor, now);
}

TimePoint DriveModel::deadline() const {
  return planned_fault_ ? std::min(power_.deadline(), planned_fault_->time) : power_.deadline();
}

/// Lets the axis move up to now; it cannot follow for long without a fault.
void DriveModel::move_axis() {
  axis_.advance(motor_drive(), now_);
  if (!drive::is_energised(power_.state())) values_.release();
  if (!is_enabled() || !axis_.has_following_error()) return;
  if (!raise_alarm(profile_->rules.fault.following_alarm)) raise_fault(kFollowingErrorFault, {}, now_);
}

bool DriveModel::set_on_panel(const std::string& id, std::int64_t value) {
  const auto* found = parameter(id);
  if (found == nullptr) return false;
  if (!found->object) {
    panel()[id] = value;
    return true;
  }
  const auto* entry = profile_->dictionary.find(*found->object);
  if (entry == nullptr) return false;
  const auto typed = od::parse_value(entry->type, fmt::to_string(value));
  if (!typed) return false;
  const auto bytes = od::encode(entry->type, *typed);
  if (!bytes || values_.check_write(*found->object, *bytes, node_) != 0) return false;
  memory_->cells(key_)[*found->object] = *bytes;
  values_.set(*found->object, *bytes);
  values_.start();
  return memory_->save().has_value();
}

std::optional<std::uint64_t> DriveModel::setting(const std::string& id) const {
  const auto* found = parameter(id);
  if (found == nullptr || !found->object) return std::nullopt;
  return effective(*found->object);
}

}  // namespace servoctl::sim
