#include "cabinet/axis_sheet.hpp"

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/pdo_index.hpp"
#include "cabinet/axis_plan.hpp"
#include "drive/naming.hpp"
#include "settings/comparison.hpp"

namespace servoctl::cabinet {
namespace {

using report::Record;
using report::Show;
using report::Value;

template <class T>
Value number_or_null(const std::optional<T>& value) {
  return value ? Value(std::uint64_t{*value}) : Value();
}

Record limits_record(const Limits& limits) {
  return {
      {"speed", report::text_or_null(limits.speed)},
      {"torque", report::text_or_null(limits.torque)},
      {"window", report::text_or_null(limits.window)},
      {"following_error", report::text_or_null(limits.following_error), Show::everywhere, "following error"}};
}

/// One line for each value of the file. PDOs have a part of their own: here stand those that are not as the
/// file says.
report::Table values_of(const drive::Profile& profile, std::uint8_t node, const AxisPlan& plan,
                        bool chinese) {
  report::Table out;
  out.columns = {{"object", "", Show::text},
                 {"index", "", Show::json},
                 {"sub", "", Show::json},
                 {"id", "", Show::json},
                 {"name"},
                 {"wanted", "the file says"},
                 {"present", "the drive"},
                 {"held"}};
  settings::Side file{"", node, {}};
  for (const auto& entry : plan.wanted.entries)
    if (entry.bytes) file.values.emplace(entry.object, *entry.bytes);
  const settings::Side drive{"", node, plan.present};
  for (const auto& [object, bytes] : file.values) {
    const auto present = drive.values.find(object);
    const bool held = present != drive.values.end() && present->second == bytes;
    const auto target = drive::target_at(&profile, object);
    const bool is_parameter = target.parameter != nullptr;
    const auto stands_for = is_parameter && target.parameter->mirror ? *target.parameter->mirror : object;
    if (held && pdo_at(stands_for.index)) continue;
    out.rows.push_back({is_parameter ? target.parameter->id : to_string(object), object.index, object.sub,
                        is_parameter ? Value(target.parameter->id) : Value(),
                        report::text_or_null(chinese ? target.label_zh() : target.label()),
                        settings::value_text(&profile, file, object, chinese),
                        settings::value_text(&profile, drive, object, chinese), held});
  }
  return out;
}

}  // namespace

std::string load_text(const Axis& axis) {
  return axis.load ? formatted("{} {}/rev", plain_number(axis.load->per_rev, 6), axis.load->unit)
                   : std::string();
}

Value pdos_text(const Axis& axis) {
  const auto& pdos = axis.pdos;
  if (!pdos.preset.empty()) return pdos.preset;
  if (!pdos.file.empty()) return pdos.file.filename().string();
  const auto count = pdos.recipes.size();
  return count == 0 ? Value() : Value(count == 1 ? std::string("1 PDO") : formatted("{} PDOs", count));
}

Result<Value> axis_sheet(show::Desk& desk, const Cabinet& cabinet, const Axis& axis,
                         std::span<const drive::Family> families) {
  const auto plan = plan_axis(desk, cabinet, axis, {.unlisted = false, .families = families});
  if (!plan) return fail(plan.error());
  const auto ms = axis.heartbeat
                      ? Value(std::chrono::duration_cast<std::chrono::milliseconds>(*axis.heartbeat).count())
                      : Value();
  return Value(
      Record{{"file", cabinet.file.filename().string()},
             {"bus", axis.bus},
             {"groups", report::List(axis.groups.begin(), axis.groups.end()), Show::json},
             {"serial", number_or_null(axis.serial), Show::everywhere, "serial number"},
             {"turn", number_or_null(axis.turn), Show::everywhere, "increments per revolution"},
             {"encoder", number_or_null(axis.encoder), Show::everywhere, "encoder counts per revolution"},
             {"load", report::text_or_null(load_text(axis))},
             {"limits", limits_record(axis.limits)},
             {"heartbeat_ms", ms, Show::everywhere, "heartbeat ms"},
             {"pdos", pdos_text(axis), Show::everywhere, "PDOs"},
             {"compared", plan->compared},
             {"different", plan->different},
             {"values", values_of(*desk.profile, axis.node, *plan, desk.chinese)}});
}

}  // namespace servoctl::cabinet
