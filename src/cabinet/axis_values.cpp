#include "cabinet/axis_values.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "drive/bitrate.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "pdo/pdo_recipes.hpp"
#include "pdo/pdo_source.hpp"
#include "session/open_bus.hpp"
#include "session/pdo_change.hpp"
#include "session/pdo_setup.hpp"
#include "settings/change.hpp"
#include "settings/comparison.hpp"

namespace servoctl::cabinet {
namespace {

using drive::PdoRecipe;

/// The error with the place in the file before it.
tl::unexpected<Error> at_place(const Cabinet& cabinet, const Axis& axis, Place place, Error error) {
  const auto placed = cabinet_error(cabinet, axis, place, error.message);
  error.message = placed.message;
  error.line = placed.line;
  if (error.code == Errc::usage) error.code = Errc::file;  // It is the file that says it.
  return fail(std::move(error));
}

Result<std::vector<PdoRecipe>> recipes_of(const drive::Profile& profile, const Cabinet& cabinet,
                                          const Axis& axis) {
  if (!axis.pdos.recipes.empty()) return axis.pdos.recipes;
  if (!axis.pdos.file.empty()) {
    auto file = pdo::read_pdo_source(profile, cabinet.file.parent_path() / axis.pdos.file);
    if (!file) return at_place(cabinet, axis, axis.pdos.at, file.error());
    return std::move(file->pdos);
  }
  const auto& presets = profile.rules.pdo.presets;
  const auto found = std::find_if(presets.begin(), presets.end(), [&](const drive::PdoPreset& preset) {
    return equals_nocase(preset.name, axis.pdos.preset);
  });
  if (found != presets.end()) return found->pdos;
  std::vector<std::string> names;
  for (const auto& preset : presets) names.push_back(preset.name);
  return at_place(cabinet, axis, axis.pdos.at,
                  make_error(Errc::usage,
                             message("the manual of {} has no mapping for '{}'", as_it_is(profile.family),
                                     as_it_is(axis.pdos.preset)),
                             names.empty() ? Message("it has none: write them as tables")
                                           : message("use {}", one_of(names))));
}

/// What is written for one axis, in the making.
class Wanted {
 public:
  /// `held`: what a drive that is not there held; null: it is there.
  Wanted(show::Desk& desk, const Cabinet& cabinet, const Axis& axis, bool keep, const session::Values* held)
      : desk_(&desk), cabinet_(&cabinet), axis_(&axis), keep_(keep), held_(held) {
    out_.family = desk.profile->family;
    out_.identity.node = axis.node;
  }

  Result<settings::Backup> make() {
    if (held_ == nullptr && keep_)
      if (const auto done = add_place(); !done) return fail(done.error());
    for (const auto& setting : axis_->parameters)
      if (const auto done = add_parameter(setting); !done) return fail(done.error());
    if (axis_->pdos.said())
      if (const auto done = add_pdos(); !done) return fail(done.error());
    if (axis_->heartbeat)
      if (const auto done = add_heartbeat(); !done) return fail(done.error());
    std::sort(out_.entries.begin(), out_.entries.end(),
              [](const auto& a, const auto& b) { return a.object < b.object; });
    return std::move(out_);
  }

 private:
  /// A node-ID or a bitrate that is stored and not that of the file takes the drive away when it starts next.
  /// The bitrate is written only where the bus runs at that of the file: else it would lead away itself.
  Result<void> add_place() {
    const auto& profile = *desk_->profile;
    if (desk_->session->network().is_ring() || desk_->session->modbus() != nullptr) return {};
    if (const auto done = add_stored(profile.rules.nmt.node_id, axis_->node, axis_->at); !done) return done;
    const auto* bus = cabinet_->bus(axis_->bus);
    if (bus == nullptr || bus->bitrate.empty()) return {};
    const auto rate = drive::parse_bitrate(bus->bitrate);
    if (!rate || !session::runs_at(desk_->session->url(), *rate)) return {};
    const auto code = drive::bitrate_code(profile, *rate);
    return code ? add_stored(profile.rules.nmt.bitrate, *code, bus->at) : Result<void>();
  }

  /// A parameter of the drive's address; its length is the drive's.
  Result<void> add_stored(const std::string& name, std::int64_t value, Place place) {
    if (name.empty()) return {};
    const auto target = drive::resolve(desk_->profile, name);
    if (!target) return fail(target.error());
    const auto held = desk_->session->upload(axis_->node, target->address);
    if (!held) return fail(held.error());
    const auto meaning = drive::fitted(drive::meaning(*target, axis_->node), held->size());
    const auto data = od::encode(meaning.type, od::Value(value));
    if (!data) return at_place(*cabinet_, *axis_, place, data.error());
    if (*data != *held) add_entry(target->address, *data, place);
    return {};
  }

  Result<void> add_parameter(const Setting& setting) {
    const auto target = drive::resolve(desk_->profile, setting.name);
    if (!target) return at_place(*cabinet_, *axis_, setting.at, target.error());
    const auto text = in_units_of_motor(*axis_, setting.value);
    if (held_ != nullptr) return add_by_data(setting, *target, text);
    const auto change = settings::make_change(*desk_, axis_->node, *target, text, std::nullopt);
    if (!change) return at_place(*cabinet_, *axis_, setting.at, change.error());
    return add_all({{target->address, change->data}}, setting.at);
  }

  /// By the family's data alone, and the length of what was held.
  Result<void> add_by_data(const Setting& setting, const drive::Target& target, const std::string& text) {
    auto meaning = drive::meaning(target, axis_->node);
    if (const auto held = held_->find(target.address); held != held_->end())
      meaning = drive::fitted(meaning, held->second.size());
    else if (!meaning.size_known)
      meaning.type_known = false;
    if (!meaning.type_known || (meaning.measure && drive::needs_bridge(meaning, text))) {
      desk_->notices.push_back(message("axis {}: {} = {} is not compared: only its drive tells what that is",
                                       as_it_is(axis_->name), as_it_is(setting.name),
                                       as_it_is(setting.value)));
      return {};
    }
    const auto value = drive::parse_quantity(meaning, text);
    if (!value) return at_place(*cabinet_, *axis_, setting.at, value.error());
    const auto data = od::encode(meaning.type, *value);
    if (!data) return at_place(*cabinet_, *axis_, setting.at, data.error());
    return add(target.address, *data, setting.at);
  }

  Result<session::Values> present_pdos() const {
    if (held_ != nullptr) return *held_;
    const std::uint8_t nodes[] = {axis_->node};
    return std::move(session::read_pdo_values(*desk_->session, desk_->profile, nodes).front());
  }

  Result<void> add_pdos() {
    const auto recipes = recipes_of(*desk_->profile, *cabinet_, *axis_);
    if (!recipes) return fail(recipes.error());
    const auto read = present_pdos();
    if (!read) return fail(read.error());
    const pdo::PresentPdos present{axis_->node, *read, session::pdos_of(*read)};
    const auto wanted = pdo::follow(*desk_->profile, present, *recipes);
    if (!wanted) return at_place(*cabinet_, *axis_, axis_->pdos.at, wanted.error());
    session::Values values = wanted->assignments;
    for (const auto& pdo : wanted->pdos)
      for (auto& [object, data] : session::values_of(pdo, present.values)) values.emplace(object, data);
    return add_all(std::move(values), axis_->pdos.at);
  }

  Result<void> add_heartbeat() {
    const auto& profile = *desk_->profile;
    if (profile.dictionary.find(objects::kProducerHeartbeat) == nullptr)
      return at_place(*cabinet_, *axis_, axis_->heartbeat_at,
                      make_error(Errc::file, message("{} has no heartbeat (1017h)", as_it_is(profile.family)),
                                 "leave `heartbeat` out"));
    const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(*axis_->heartbeat);
    return add_parameter(
        {to_string(objects::kProducerHeartbeat), formatted("{}", milliseconds.count()), axis_->heartbeat_at});
  }

  Result<void> add_all(session::Values values, Place place) {
    if (keep_) session::add_stored_copies(*desk_->profile, axis_->node, values);
    for (const auto& [object, data] : values)
      if (const auto done = add(object, data, place); !done) return done;
    return {};
  }

  Result<void> add(ObjectAddress object, const Bytes& data, Place place) {
    const auto target = drive::target_at(desk_->profile, object);
    const auto name = settings::name_of(target);
    const auto refuse = [&](Message why, Message hint) {
      return at_place(*cabinet_, *axis_, place, make_error(Errc::file, std::move(why), std::move(hint)));
    };
    if (settings::is_address(desk_->profile, object))
      return refuse(message("{} is node-ID or bitrate of the drive", name),
                    "`node` and `bitrate` say them; they are not written as parameters");
    const auto first = std::find_if(out_.entries.begin(), out_.entries.end(),
                                    [&](const auto& entry) { return entry.object == object; });
    if (first != out_.entries.end()) {
      if (*first->bytes == data) return {};
      return refuse(message("{} has another value in line {}", name, first->line), "remove one of them");
    }
    add_entry(object, data, place);
    return {};
  }

  void add_entry(ObjectAddress object, const Bytes& data, Place place) {
    const auto target = drive::target_at(desk_->profile, object);
    settings::Backup::Entry entry;
    entry.object = object;
    entry.id = target.parameter != nullptr ? target.parameter->id : std::string();
    entry.name = target.label();
    entry.type = drive::fitted(drive::meaning(target, axis_->node), data.size()).type;
    entry.bytes = data;
    entry.line = place.line;
    out_.entries.push_back(std::move(entry));
  }

  show::Desk* desk_;
  const Cabinet* cabinet_;
  const Axis* axis_;
  bool keep_;
  const session::Values* held_;
  settings::Backup out_;
};

}  // namespace

Result<settings::Backup> wanted_backup(show::Desk& desk, const Cabinet& cabinet, const Axis& axis,
                                       bool keep) {
  return Wanted(desk, cabinet, axis, keep, nullptr).make();
}

Result<settings::Backup> wanted_of_held(show::Desk& desk, const Cabinet& cabinet, const Axis& axis,
                                        const session::Values& held) {
  return Wanted(desk, cabinet, axis, false, &held).make();
}

std::string in_units_of_motor(const Axis& axis, const std::string& text) {
  return axis.load ? drive::in_revolutions(*axis.load, text).value_or(text) : text;
}

}  // namespace servoctl::cabinet
