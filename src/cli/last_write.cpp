#include "cli/last_write.hpp"

#include <algorithm>
#include <array>

#include "base/format.hpp"
#include "cabinet/cabinet.hpp"
#include "cli/axis_lines.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "session/identify.hpp"
#include "session/pdo_change.hpp"
#include "settings/change.hpp"
#include "settings/comparison.hpp"
#include "show/reading.hpp"

namespace servoctl::cli {
namespace {

using command::Context;

/// Objects that drive the motor or an output, or say how: to write them back is a movement, and no
/// correction.
constexpr std::array<std::uint16_t, 11> kMoving{0x6040, 0x6042, 0x6060, 0x6071, 0x607A, 0x60B0,
                                                0x60B1, 0x60B2, 0x60C1, 0x60FE, 0x60FF};

bool is_moving(ObjectAddress object) {
  return std::find(kMoving.begin(), kMoving.end(), object.index) != kMoving.end();
}

/// Also where the family has another name for it: a panel parameter that is the same value, or what an
/// enabled drive follows at once. `profile` may be null.
bool drives_motor(const drive::Profile* profile, const drive::Target& target) {
  const auto* parameter = target.parameter;
  const bool same = parameter != nullptr && parameter->mirror && is_moving(*parameter->mirror);
  const bool followed = profile != nullptr && settings::is_target(*profile, target.address);
  return is_moving(target.address) || same || followed;
}

/// `profile` may be null.
std::string why_not_back(const drive::Profile* profile, const drive::Target& target,
                         const drive::Meaning& meaning) {
  const auto* entry = target.entry;
  const auto* parameter = target.parameter;
  const auto index = target.address.index;
  if (drives_motor(profile, target)) return "it drives the motor, and is no setting";
  const bool action = index == objects::kStoreIndex || index == objects::kRestoreIndex ||
                      (entry != nullptr && entry->command) || (parameter != nullptr && parameter->command);
  if (action) return "it starts an action";
  if ((entry != nullptr && entry->is_volatile) || (parameter != nullptr && parameter->is_volatile))
    return "it is no setting";
  if (!od::readable(meaning.access)) return "it cannot be read";
  return {};
}

/// The value as a line writes it; empty where no text stands for just these bytes.
std::string text_of(const drive::Meaning& meaning, const Bytes& bytes) {
  const auto value = od::decode(meaning.type, bytes);
  if (!value) return {};
  auto text = drive::plain_text(meaning, *value);
  const auto back = drive::parse_quantity(meaning, text);
  const auto again = back ? od::encode(meaning.type, *back) : Result<Bytes>(Bytes());
  return again && *again == bytes ? text : std::string();
}

/// As the line that writes it takes it; what fits no type is told by that.
drive::Meaning with_known_type(std::uint8_t node, const drive::Target& target, const drive::Meaning& meaning,
                               const Bytes& bytes) {
  if (meaning.type_known && meaning.size_known) return meaning;
  return settings::learned_meaning(node, target, meaning, bytes).value_or(meaning);
}

/// As people read it.
std::string readable_text(const drive::Target& target, std::uint8_t node, const drive::Meaning& meaning,
                          const Bytes& bytes) {
  const auto decoded = show::decode_value({.node = node, .target = target, .type = meaning.type}, bytes);
  const auto* label = std::get_if<std::string>(&decoded.label.data());
  return decoded.text + (label == nullptr ? "" : " (" + *label + ")");
}

std::string name_of_node(const Context& context, std::uint8_t node) {
  for (const auto* axis : context.axes)
    if (axis->node == node) return axis->name;
  return std::to_string(node);
}

/// A panel parameter goes by its number; that of an object may have been typed, and says little.
std::string shown_name(const drive::Target& target, const std::string& typed) {
  return target.parameter != nullptr ? typed : target.in_sentence();
}

}  // namespace

/// Asked for once between two restarts.
const session::Identity* LastWrite::identity_of(session::Session& session, std::uint8_t node) {
  const auto key = std::tuple(opening_, node, session.watch().boots(node));
  auto found = identities_.find(key);
  if (found == identities_.end()) {
    auto identity = session::read_identity(session, node);
    if (!identity) return nullptr;
    found = identities_.emplace(key, std::move(*identity)).first;
  }
  return &found->second;
}

void LastWrite::look(const command::Command& command, const command::Arguments& arguments,
                     const Context& context, const Settings& settings, std::uint64_t opening) {
  pending_.reset();
  opening_ = opening;
  const bool writes = command.path == "param set" || command.path == "write";
  if (!enabled_ || !writes || context.dry_run || context.session == nullptr) return;
  pending_ = Line{.command = std::string(command.path),
                  .bus = settings.bus,
                  .place = place_,
                  .drive = settings.drive,
                  .by_axis = !context.axes.empty() && (settings.nodes_typed() || names_axes(place_)),
                  .of_cabinet = settings.of_cabinet,
                  .names = settings.names,
                  .keep = arguments.has("--keep"),
                  .unlock = arguments.has("--unlock"),
                  .values = {},
                  .why_not = {}};
  const auto named = command.settings(arguments);
  if (!named) {
    pending_->why_not = "it wrote a file";
    return;
  }
  for (const auto node : context.nodes)
    for (const auto& one : *named) look_at(context, one, node);
}

void LastWrite::look_at(const Context& context, const settings::NamedValue& named, std::uint8_t node) {
  const auto target = named.panel && context.profile != nullptr
                          ? drive::resolve_panel(*context.profile, named.name)
                          : drive::resolve(context.profile, named.name);
  if (!target) return;  // The line will be refused.
  auto meaning = drive::meaning(*target, node);
  if (named.type) meaning.type = *named.type;
  auto why = why_not_back(context.profile, *target, meaning);
  const auto before = why.empty() ? context.session->upload(node, target->address) : Result<Bytes>(Bytes());
  if (why.empty() && before && !named.type) meaning = with_known_type(node, *target, meaning, *before);
  if (why.empty() && before && pending_->keep && context.profile != nullptr) {
    session::Values both{{target->address, *before}};
    session::add_stored_copies(*context.profile, node, both);
    if (both.size() > 1) why = "`--keep` wrote the parameter too that the drive copies into it at its start";
  }
  const auto* identity = why.empty() ? identity_of(*context.session, node) : nullptr;
  if (why.empty() && (!before || identity == nullptr)) why = "what it held before could not be read";
  const auto text = why.empty() ? text_of(meaning, *before) : std::string();
  if (why.empty() && text.empty()) why = "what it held before cannot be written as a text";
  if (!why.empty()) {
    pending_->why_not = formatted("{} on node {}: {}", named.name, node, why);
    return;
  }
  pending_->values.push_back({.node = node,
                              .target = name_of_node(context, node),
                              .name = named.name,
                              .shown = shown_name(*target, named.name),
                              .object = target->address,
                              .type = named.type ? std::string(od::name(*named.type)) : std::string(),
                              .before = *before,
                              .after = {},
                              .before_text = text,
                              .after_text = {},
                              .before_shown = readable_text(*target, node, meaning, *before),
                              .after_shown = {},
                              .identity = *identity,
                              .opening = opening_,
                              .boots = context.session->watch().boots(node)});
}

void LastWrite::settle(const Context& context) {
  if (!pending_) return;
  auto line = std::move(*pending_);
  pending_.reset();
  if (!line.why_not.empty()) {
    // What could not be looked at may have been written all the same.
    line.values.clear();
    line_ = std::move(line);
    return;
  }
  std::vector<Value> changed;
  for (auto& value : line.values) {
    const auto now = context.session->upload(value.node, value.object);
    if (now && *now == value.before) continue;
    const auto target = drive::target_at(context.profile, value.object);
    auto meaning = with_known_type(value.node, target, drive::meaning(target, value.node), value.before);
    if (const auto type = od::parse_data_type(value.type)) meaning.type = *type;
    if (now)
      value.after = *now;
    else
      line.why_not = formatted("{} on node {}: what it holds now could not be read", value.name, value.node);
    if (now) value.after_text = text_of(meaning, *now);
    if (now) value.after_shown = readable_text(target, value.node, meaning, *now);
    changed.push_back(std::move(value));
  }
  if (changed.empty()) return;
  line.values = std::move(changed);
  line_ = std::move(line);
}

void LastWrite::keep(Line line) { line_ = std::move(line); }

void LastWrite::turn_round(Line line) {
  for (auto& value : line.values) {
    std::swap(value.before, value.after);
    std::swap(value.before_text, value.after_text);
    std::swap(value.before_shown, value.after_shown);
    if (value.before_text.empty()) line.why_not = "what it held before cannot be written as a text";
  }
  line.turned = !line.turned;
  line_ = std::move(line);
}

void LastWrite::give_up(const command::Command& command, std::string why) {
  pending_.reset();
  if (!enabled_ || command.settings == nullptr || command.effect != command::Effect::writes) return;
  line_ = Line{};
  line_->why_not = std::move(why);
}

}  // namespace servoctl::cli
