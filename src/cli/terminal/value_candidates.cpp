// Names and values of objects and panel parameters, as the data of the family has them.
#include <algorithm>
#include <array>

#include "base/format.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "cli/terminal/candidates.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "drive/unit.hpp"
#include "report/catalogue.hpp"
#include "show/pdo_check.hpp"

namespace servoctl::cli {
namespace {

/// Which object a value of a command goes to.
struct ValueOfCommand {
  std::string_view path;
  std::string_view parameter;
  std::string_view object;
};
constexpr std::array kValuesOfCommands{
    ValueOfCommand{"mode", "mode", "6060h"},        ValueOfCommand{"home", "method", "6098h"},
    ValueOfCommand{"test home", "method", "6098h"}, ValueOfCommand{"home", "--speed", "6099h.1"},
    ValueOfCommand{"home", "--search", "6099h.2"},  ValueOfCommand{"home", "--offset", "607Ch"},
    ValueOfCommand{"jog", "speed", "60FFh"},        ValueOfCommand{"test jog", "speed", "60FFh"},
    ValueOfCommand{"test all", "speed", "60FFh"},   ValueOfCommand{"move", "target", "607Ah"},
    ValueOfCommand{"move", "--speed", "6081h"},     ValueOfCommand{"torque", "torque", "6071h"}};

constexpr std::array kUnitNames{"us",    "ms",    "s",     "min",   "deg",    "rad",    "rev", "rpm",
                                "rev/s", "rad/s", "deg/s", "rpm/s", "rev/s2", "rad/s2", "%",   "Hz",
                                "kHz",   "V",     "mV",    "A",     "mA",     "Nm",     "mNm"};
/// Of axes whose units the drive's own gear tells.
constexpr std::array kPositionUnits{"rev", "deg", "rad"};
constexpr std::array kSpeedUnits{"rpm", "rev/s", "deg/s", "rad/s"};

const std::string& name_in(bool chinese, const std::string& name, const std::string& name_zh) {
  return chinese && !name_zh.empty() ? name_zh : name;
}

std::string address_of(ObjectAddress address, bool plain) {
  return plain ? formatted("0x{:04X}", address.index) : to_string(address);
}

/// As `begun` goes on: `0x6099:1`, or `6099h.1` where no `0x` was begun.
std::string address_like(std::string_view begun, ObjectAddress address, bool plain) {
  auto out = address_of(address, plain);
  if (begun == "0" || begun.starts_with("0x") || begun.starts_with("0X")) return out;
  const auto sub = plain ? std::string() : "." + out.substr(out.find(':') + 1);
  return formatted("{:04X}h{}", address.index, sub);
}

bool begins_as_number(std::string_view text) {
  return !text.empty() &&
         (text.front() == '-' || text.front() == '.' || (text.front() >= '0' && text.front() <= '9'));
}

/// A sign alone may begin an option.
bool has_digit(std::string_view number) {
  return number.find_first_of("0123456789") != std::string_view::npos;
}

/// Such as `pv`, which is typed as it stands.
bool is_one_word(std::string_view text) {
  constexpr std::size_t kShort = 12;
  return !text.empty() && text.size() <= kShort && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  });
}

/// The manual names it, and gives it no meaning.
bool is_reserved(const od::EnumLabel& label) { return starts_with_nocase(label.label, "reserved"); }

std::string range_of(const drive::Meaning& meaning) {
  auto out = drive::range_text(meaning);
  if (!meaning.unit.empty()) out += (out.empty() ? "" : " ") + std::string(meaning.unit);
  return out;
}

}  // namespace

bool Candidates::may_stand(const od::Entry& entry) const {
  return !mapped_ || show::may_map(entry, *mapped_);
}

void Candidates::add_objects() {
  const auto* known = profile();
  if (known == nullptr) return;
  if (begins_as_number(begun_)) return add_addresses();
  add_panel_parameters(false);
  const auto group = begin_group(Candidate::Group::objects);
  for (const auto& object : known->dictionary.objects())
    for (const auto& entry : object.entries)
      if (known->parameter(entry.address) == nullptr && may_stand(entry))
        add(drive::entry_name(object, entry),
            address_of(entry.address, object.entries.size() == 1) + (chinese_ ? " " + entry.name_zh : ""));
  if (has_chinese(begun_))
    for (const auto& object : known->dictionary.objects())
      for (const auto& entry : object.entries)
        if (known->parameter(entry.address) == nullptr && may_stand(entry))
          add(entry.name_zh, address_of(entry.address, object.entries.size() == 1));
  begin_group(group);
}

void Candidates::add_addresses() {
  const auto group = begin_group(Candidate::Group::objects);
  for (const auto& object : profile()->dictionary.objects())
    for (const auto& entry : object.entries)
      if (may_stand(entry))
        add(address_like(begun_, entry.address, object.entries.size() == 1),
            name_in(chinese_, object.entries.size() == 1 ? object.name : object.name + ": " + entry.name,
                    entry.name_zh));
  begin_group(group);
}

/// Those without a number of their own stand among the objects too.
void Candidates::add_panel_parameters(bool also_placed) {
  const auto* known = profile();
  if (known == nullptr) return;
  const auto group = begin_group(Candidate::Group::parameters);
  for (const auto& parameter : known->parameters) {
    if (parameter.placed && !also_placed) continue;
    const auto* entry = mapped_ && parameter.object ? known->dictionary.find(*parameter.object) : nullptr;
    if (mapped_ && (entry == nullptr || !may_stand(*entry))) continue;
    add(parameter.id, name_in(chinese_, parameter.name, parameter.name_zh));
    if (has_chinese(begun_)) add(parameter.name_zh, parameter.id);
  }
  begin_group(group);
}

/// `ID VALUE`, or `ID=VALUE` as often as one likes.
void Candidates::add_assignment(const std::vector<std::string>& before) {
  if (before.size() == 1 && before.front().find('=') == std::string::npos)
    return add_values_of(before.front());
  const auto equals = begun_.find('=');
  if (equals == std::string::npos) return add_panel_parameters(true);
  auto value = behind(equals + 1);
  value.add_values_of(begun_.substr(0, equals));
  take_behind(equals + 1, std::move(value));
}

void Candidates::add_values_of(std::string_view object) {
  const auto* known = profile();
  const auto target = drive::resolve(known, object);
  if (known == nullptr || !target) return;
  const auto meaning = drive::meaning(*target, 0);
  if (begins_as_number(begun_)) {
    if (meaning.labels != nullptr)
      for (const auto& label : *meaning.labels)
        if (!is_reserved(label))
          add(std::to_string(label.value), name_in(chinese_, label.label, label.label_zh));
    return add_units(meaning.unit);
  }
  if (meaning.labels != nullptr) {
    for (const auto& label : *meaning.labels) {
      if (is_reserved(label)) continue;
      const auto number = std::to_string(label.value);
      const auto name = name_in(chinese_, label.label, label.label_zh);
      const auto words = drive::label_words(label.label);
      // The shortest stands for all, as in `pv`.
      const auto word =
          *std::min_element(words.begin(), words.end(), [](auto a, auto b) { return a.size() < b.size(); });
      const bool first = drive::find_label(meaning, word) == &label;
      // What people type is the number, or a word such as `pv`; who began a name goes on with it.
      if (begun_.empty() && !(first && is_one_word(word)))
        add(number, name);
      else if (begun_.empty())
        add(word, number + " " + std::string(name));
      else
        add(chinese_ && !label.label_zh.empty() ? std::string_view(label.label_zh)
            : first                             ? word
                                                : label.label,
            number + " " + std::string(name));
    }
    return;
  }
  // A number is up to the user.
  note_ = range_of(meaning);
  if (const auto* known_as = target->parameter; known_as != nullptr && known_as->default_value)
    append(note_, "default " + od::to_string(*known_as->default_value));
}

/// The number that was begun, in the units that it may be written in.
void Candidates::add_units(std::string_view of) {
  const auto digits = begun_.find_first_not_of("-+.0123456789");
  const auto number = begun_.substr(0, digits);
  if (!has_digit(number) || begun_.starts_with("0x")) return;
  for (const auto* unit : kUnitNames)
    if (of == unit || drive::conversion(unit, of)) add(number + unit);
}

/// The number that was begun, with the units of time.
void Candidates::add_durations() {
  if (begun_.empty() || begun_.find_first_not_of(".0123456789") != std::string::npos) return;
  for (const auto* unit : {"ms", "s", "min"}) add(begun_ + unit);
}

/// Words of a text that is none of the kinds: each parameter of this name, of one command or of all.
void Candidates::add_words_of(const command::Command& command, const command::Parameter& parameter) {
  const auto is = [&](std::string_view path, std::string_view name) {
    return (path.empty() || command.path == path) && parameter.name == name;
  };
  if (is("", "pdo"))
    for (const auto* side : {"RPDO", "TPDO"})
      for (int i = 1; i <= 4; ++i) add(formatted("{}{}", side, i));
  if (is("", "--bitrate") || is("lss set-bitrate", "rate"))
    for (const auto* rate : {"125k", "250k", "500k", "1M"}) add(rate);
  if (is("sim", "drives")) add_cells(0);
  if (is("cabinet swap", "axis")) add_axes();
  if (is("clone", "--from") || is("clone", "--to") || is("cabinet swap", "--from")) add_node_numbers();
  if (const auto* known = is("pdo preset", "preset") ? profile() : nullptr; known != nullptr)
    for (const auto& preset : known->rules.pdo.presets) add(preset.name);
  const bool of_groups = is("backup", "--only") || is("param list", "pattern");
  if (is("backup", "--only"))
    for (const auto* part : {"communication", "pdo", "params", "changed"}) add(part);
  if (const auto* known = of_groups ? profile() : nullptr; known != nullptr)
    for (const auto& one : known->parameters) {
      add(one.group, "group of parameters");
      if (is("param list", "pattern") && has_chinese(begun_))
        add(report::chinese_word(one.group), "group of parameters");
    }
}

/// Words that no kind tells: those of modes, methods, units, PDOs, bitrates.
void Candidates::add_known_word(const command::Command& command, const command::Parameter& parameter) {
  add_words_of(command, parameter);
  for (const auto& value : kValuesOfCommands) {
    if (value.path != command.path || value.parameter != parameter.name) continue;
    add_values_of(value.object);
    const auto number = begun_.substr(0, begun_.find_first_not_of("-+.0123456789"));
    if (!has_digit(number)) continue;
    if (value.object == "607Ah" || value.object == "607Ch") add_motion_units(value.object, kPositionUnits);
    if (value.object == "60FFh" || value.object == "6081h" || value.object.starts_with("6099h"))
      add_motion_units(value.object, kSpeedUnits);
    if (value.object == "6071h") add(number + "%");
  }
}

/// The number that was begun. Where it may be that nobody knows what a turn is in counts, these come first,
/// and beside the others stands what they need.
void Candidates::add_motion_units(std::string_view object, std::span<const char* const> units) {
  const auto number = begun_.substr(0, begun_.find_first_not_of("-+.0123456789"));
  const auto* known = profile();
  const auto target = drive::resolve(known, object);
  const auto meaning = known != nullptr && target ? drive::meaning(*target, 0) : drive::Meaning{};
  std::string_view needs;
  if (meaning.measure && !place_.turn_said) {
    const auto ways = known->rules.units.find(*meaning.measure);
    if (ways == known->rules.units.end())
      needs = "needs --turn";
    else if (std::any_of(ways->second.begin(), ways->second.end(),
                         [](const auto& way) { return way.learned; }))
      needs = "needs --turn, or `units learn` before";
  }
  if (!needs.empty()) add(number + std::string(meaning.unit), "the drive's own unit");
  for (const auto* unit : units) add(number + unit, needs);
}

}  // namespace servoctl::cli
