// The parameters and objects that a rules file names: whether the family has them.
#include <array>

#include "drive/family_mistakes.hpp"
#include "drive/naming.hpp"
#include "drive/toml_depth.hpp"
#include "drive/toml_reader.hpp"

namespace servoctl::drive {
namespace {

/// Keys whose value is a name or a list of names; `[]` stands for each element of a list of tables.
constexpr auto kNamingKeys =
    std::to_array<std::string_view>({"nmt.node_id",           "nmt.bitrate",
                                     "nmt.autostart",         "nmt.guarding_alarm",
                                     "nmt.needs.[].name",     "store.store.[].name",
                                     "store.restore.[].name", "store.flash_switch",
                                     "store.unlock",          "store.locked",
                                     "modbus.node_id",        "modbus.baud",
                                     "modbus.framing",        "modbus.targets",
                                     "modbus.at_rest",        "modbus.shows",
                                     "motion.encoder",        "motion.position_speed",
                                     "motion.rated_speed",    "motion.rated_torque",
                                     "motion.speed_limit",    "motion.speed_monitor",
                                     "fault.alarm",           "fault.ramp",
                                     "fault.reset.[].name",   "restart.restore_defaults",
                                     "restart.clear_alarms",  "motion.without_controlword.[].name",
                                     "caution.[].name",       "motion.without_controlword.[].end",
                                     "units.learn.speed"});

class NameCheck {
 public:
  NameCheck(std::string_view file, const Profile& profile, std::vector<Error>& errors)
      : file_(file), profile_(&profile), errors_(&errors) {}

  void walk(const toml::node& node, std::string_view path, std::string_view key) {
    if (path.empty()) return look(node, key);
    const auto dot = path.find('.');
    const auto part = path.substr(0, dot);
    const auto rest = dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
    if (part == "[]") {
      if (const auto* list = node.as_array())
        for (const auto& element : *list) walk(element, rest, key);
    } else if (const auto* table = node.as_table()) {
      if (const auto* inside = table->get(part)) walk(*inside, rest, part);
    }
  }

 private:
  void look(const toml::node& node, std::string_view key) {
    if (const auto* list = node.as_array()) {
      for (const auto& element : *list) look(element, key);
      return;
    }
    std::string name;
    if (!get(node, name) || name.empty() || parse_object_address(name) || profile_->parameter(name)) return;
    const auto found = resolve_panel(*profile_, name);
    if (found || resolve(profile_, name)) return;
    const auto at = node.source().begin;
    auto error =
        file_error(file_, at.line, at.column,
                   message("'{}' names {}, which is neither a parameter nor an object", as_it_is(key), name));
    error.hint = found.error().hint;
    errors_->push_back(std::move(error));
  }

  std::string_view file_;
  const Profile* profile_;
  std::vector<Error>* errors_;
};

}  // namespace

void check_rule_names(std::string_view toml, std::string_view file, const Profile& profile,
                      std::vector<Error>& errors) {
  if (!check_toml_depth(toml, file)) return;
  const auto parsed = toml::parse(toml, file);
  if (!parsed) return;
  for (const auto path : kNamingKeys) NameCheck(file, profile, errors).walk(parsed.table(), path, {});
}

}  // namespace servoctl::drive
