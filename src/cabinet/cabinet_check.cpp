#include "cabinet/cabinet_check.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <set>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "cabinet/axis_values.hpp"
#include "drive/drive_settings.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "drive/unit.hpp"
#include "pdo/pdo_changing.hpp"
#include "pdo/pdo_source.hpp"
#include "settings/change.hpp"
#include "settings/comparison.hpp"

namespace servoctl::cabinet {
namespace {

constexpr ObjectAddress kHeartbeatTime{0x1017, 0};

/// Everything that can be said of one axis without its drive.
class AxisCheck {
 public:
  AxisCheck(const Cabinet& cabinet, const Axis& axis, const drive::Profile& profile)
      : cabinet_(&cabinet), axis_(&axis), profile_(&profile) {
    desk_.profile = &profile;
  }

  /// What is no fault, and worth a look.
  std::vector<Message> take_notices() { return std::move(notices_); }

  std::vector<Error> run() {
    for (const auto& setting : axis_->parameters) check_setting(setting);
    check_heartbeat();
    check_pdos();
    check_limits();
    return std::move(errors_);
  }

 private:
  void check_setting(const Setting& setting) {
    const auto target = drive::resolve(profile_, setting.name);
    if (!target) return add(setting.at, target.error());
    if (target->entry == nullptr && !profile_->is_generic())
      notices_.push_back(
          cabinet_error(*cabinet_, *axis_, setting.at,
                        message("{} is not in the data of {}: its size and limits are asked of the drive",
                                as_it_is(setting.name), as_it_is(profile_->family)))
              .message);
    const auto twice = places_.emplace(target->address, &setting);
    if (!twice.second)
      return add(
          setting.at,
          make_error(Errc::file, message("{} is {} as well, in line {}", as_it_is(setting.name),
                                         as_it_is(twice.first->second->name), twice.first->second->at.line)));
    if (settings::is_address(profile_, target->address))
      return add(
          setting.at,
          make_error(Errc::file, message("{} is node-ID or bitrate of the drive", as_it_is(setting.name)),
                     "`node` and `bitrate` say them; they are not written as parameters"));
    if (const auto reason = no_setting(*target); !reason.empty())
      return add(setting.at,
                 make_error(Errc::file, message("{} is no setting: {}", as_it_is(setting.name), reason),
                            "`param explain` tells more"));
    if (const auto fits =
            settings::check_change(desk_, axis_->node, *target, in_units_of_motor(*axis_, setting.value), {});
        !fits)
      add(setting.at, with_name(setting, fits.error()));
  }

  /// Why the object is nothing that a drive keeps; empty where it is.
  std::string_view no_setting(const drive::Target& target) {
    if (left_out_.empty())
      for (const auto& setting : drive::settings_of(*profile_))
        left_out_.emplace(setting.entry->address, setting.left_out);
    const auto found = left_out_.find(target.address);
    return found == left_out_.end() ? std::string_view() : found->second;
  }

  static Error with_name(const Setting& setting, Error error) {
    if (!error.message.names(setting.name))
      error.message = message("{}: {}", as_it_is(setting.name), error.message);
    return error;
  }

  void check_heartbeat() {
    if (!axis_->heartbeat) return;
    const auto target = drive::target_at(profile_, kHeartbeatTime);
    if (target.entry == nullptr)
      return add(axis_->heartbeat_at,
                 make_error(Errc::file, message("{} has no heartbeat (1017h)", as_it_is(profile_->family))));
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(*axis_->heartbeat).count();
    if (const auto fits = settings::check_change(desk_, axis_->node, target, std::to_string(ms), {}); !fits)
      add(axis_->heartbeat_at, fits.error());
    if (const auto twice = places_.find(kHeartbeatTime); twice != places_.end())
      add(twice->second->at, make_error(Errc::file, message("'heartbeat' in line {} says 1017h as well",
                                                            axis_->heartbeat_at.line)));
  }

  void check_pdos() {
    const auto& pdos = axis_->pdos;
    if (!pdos.preset.empty()) {
      std::vector<std::string> names;
      for (const auto& preset : profile_->rules.pdo.presets) names.push_back(preset.name);
      if (std::none_of(names.begin(), names.end(),
                       [&](const auto& name) { return equals_nocase(name, pdos.preset); }))
        add(pdos.at, make_error(Errc::file,
                                message("{} has no PDO preset '{}'", as_it_is(profile_->family),
                                        as_it_is(pdos.preset)),
                                names.empty() ? "it has none" : message("it has {}", one_of(names))));
    }
    if (pdos.file.empty()) return check_recipes(pdos.recipes);
    const auto file = pdo::read_pdo_source(*profile_, cabinet_->file.parent_path() / pdos.file);
    if (!file) return add(pdos.at, file.error());
    check_recipes(file->pdos);
  }

  void check_recipes(const std::vector<drive::PdoRecipe>& recipes) {
    for (const auto& recipe : recipes) {
      const Place at{recipe.line == 0 || !axis_->pdos.file.empty() ? axis_->pdos.at.line : recipe.line,
                     axis_->pdos.at.column};
      if (const auto known = check_pdo_name(recipe.pdo); !known) {
        add(at, known.error());
        continue;
      }
      for (const auto& word : recipe.map.value_or(std::vector<std::string>()))
        if (const auto entry = pdo::parse_mapped(*profile_, word); !entry) {
          auto error = entry.error();
          error.message = message("{}: {}", as_it_is(recipe.pdo), error.message);
          add(at, error);
        }
    }
  }

  Result<void> check_pdo_name(const std::string& name) const {
    const auto pdo = canopen::parse_pdo_name(name);
    if (!pdo)
      return fail(Errc::file, message("'{}' is not a PDO", as_it_is(name)),
                  "RPDO1, TPDO2: as the drive sees them");
    const ObjectAddress mapping{pdo->mapping_index(), 0};
    if (profile_->is_generic() || drive::target_at(profile_, mapping).entry != nullptr) return {};
    return fail(Errc::file,
                message("{} has no {}", as_it_is(profile_->family),
                        as_it_is(canopen::name(pdo->direction, pdo->number))),
                message("`objects '0x{:02X}*' -d {}` lists what it has", mapping.index >> 8U,
                        as_it_is(profile_->family)));
  }

  void check_limits() {
    const auto& limits = axis_->limits;
    check_limit("speed", limits.speed, {"rpm", "inc/s", "pps"});
    check_limit("torque", limits.torque, {"%", "Nm", "A"});
    check_limit("window", limits.window, {"deg", "inc"});
    check_limit("following_error", limits.following_error, {"deg", "inc"});
  }

  void check_limit(std::string_view name, const std::string& text,
                   std::initializer_list<std::string_view> units) {
    if (text.empty()) return;
    const auto motor = axis_->load ? drive::size_in_revolutions(*axis_->load, text) : std::nullopt;
    const auto said = motor.value_or(text);
    const auto number = drive::split_unit(said);
    const bool fits =
        number && number->number > 0 && std::any_of(units.begin(), units.end(), [&](std::string_view unit) {
          return drive::conversion(number->unit, unit).has_value();
        });
    if (fits) return check_range(name, text, *number);
    std::vector<std::string> all(units.begin(), units.end());
    if (axis_->load && name != "torque") all.push_back(axis_->load->unit + (name == "speed" ? "/s" : ""));
    auto known = message("{}", NameList{all});
    if (!axis_->load && name != "torque") known += "; `per_turn` makes other units known";
    add(axis_->limits.at,
        make_error(Errc::file, message("limits: {} = \"{}\" is no limit", as_it_is(name), as_it_is(text)),
                   message("a number above 0 in {}", known)));
  }

  /// A torque that is in the unit of the drive's own limit is held against the range of that.
  void check_range(std::string_view name, const std::string& text, const drive::NumberWithUnit& number) {
    const auto target = drive::target_at(profile_, objects::kMaxTorque);
    if (name != "torque" || target.entry == nullptr) return;
    if (drive::meaning(target, axis_->node).unit != number.unit) return;
    const auto fits = settings::check_change(desk_, axis_->node, target, text, {});
    if (fits) return;
    add(axis_->limits.at,
        make_error(Errc::file, message("limits: torque = \"{}\": {}", as_it_is(text), fits.error().message),
                   fits.error().hint));
  }

  void add(Place at, const Error& error) {
    errors_.push_back(cabinet_error(*cabinet_, *axis_, at, error.message, error.hint));
  }

  const Cabinet* cabinet_;
  const Axis* axis_;
  const drive::Profile* profile_;
  show::Desk desk_;
  std::map<ObjectAddress, const Setting*> places_;
  std::map<ObjectAddress, std::string_view> left_out_;
  std::vector<Error> errors_;
  std::vector<Message> notices_;
};

/// Forty axes that share a line share what there is to say of it.
class ToldOnce {
 public:
  bool is_new(const Axis& axis, std::string text) {
    const auto name = formatted("axis {}: ", axis.name);
    if (const auto at = text.find(name); at != std::string::npos) text.erase(at, name.size());
    return told_.insert(std::move(text)).second;
  }

 private:
  std::set<std::string> told_;
};

/// Names that differ in the case of letters alone: one letter too large moves another motor.
class AlikeNames {
 public:
  explicit AlikeNames(const Cabinet& cabinet) : cabinet_(&cabinet) {}

  std::vector<Error> find() {
    for (const auto& bus : cabinet_->buses) add("bus", bus.name, bus.at, buses_);
    for (const auto& axis : cabinet_->axes) add("axis", axis.name, axis.at, axes_);
    for (const auto& axis : cabinet_->axes)
      for (const auto& group : axis.groups) add("group", group, axis.at, axes_);
    return std::move(errors_);
  }

 private:
  using Names = std::map<std::string, std::string>;  ///< In small letters, and as they are.

  void add(std::string_view what, const std::string& name, Place at, Names& names) {
    const auto& first = names.emplace(lower(name), name).first->second;
    if (first == name || !told_.insert(name).second) return;
    auto error = file_error(
        cabinet_->file.string(), at.line, at.column,
        message("{} {} differs from {} in the case of letters alone", what, as_it_is(name), as_it_is(first)));
    error.hint = "a slip at the keyboard would move the other: give one of them another name";
    errors_.push_back(std::move(error));
  }

  const Cabinet* cabinet_;
  Names buses_;
  Names axes_;
  std::set<std::string> told_;
  std::vector<Error> errors_;
};

}  // namespace

CabinetFindings check_cabinet(const Cabinet& cabinet, const LoadProfile& load) {
  CabinetFindings out;
  out.errors = AlikeNames(cabinet).find();
  ToldOnce told;
  for (const auto& axis : cabinet.axes) {
    const auto profile = load(axis.family);
    if (!profile) {
      const auto& tells = profile.error().hint;
      auto hint = tells.empty() ? Message("correct `family`") : message("correct `family`; {}", tells);
      auto error = cabinet_error(cabinet, axis, axis.at, profile.error().message, std::move(hint));
      if (told.is_new(axis, error.message.text())) out.errors.push_back(std::move(error));
      continue;
    }
    AxisCheck check(cabinet, axis, **profile);
    for (auto& error : check.run())
      if (told.is_new(axis, error.message.text())) out.errors.push_back(std::move(error));
    for (auto& notice : check.take_notices())
      if (told.is_new(axis, notice.text())) out.notices.push_back(std::move(notice));
  }
  return out;
}

}  // namespace servoctl::cabinet
