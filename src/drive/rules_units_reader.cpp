// `[units]` of a rules file: how measures of a drive are made of its objects.
#include "drive/rules_reader.hpp"

namespace servoctl::drive {
namespace {

bool get(const toml::node& node, Quotient::When& out) {
  return has_only(node, {"object", "value"}) && drive::get(at(node, "object"), out.object) &&
         get_int(at(node, "value"), out.value);
}

bool get(const toml::node& node, Quotient::Factor& out) {
  ObjectAddress object;
  if (drive::get(node, object)) {
    out = object;
    return true;
  }
  const auto number = node.value<double>();
  if (!number || *number == 0) return false;
  out = *number;
  return true;
}

bool get(const toml::node& node, Quotient& out);

template <class T>
TableReader::Handler quotient_list_into(std::vector<T>& out) {
  return [&out](const toml::node& node) {
    return get_list(node, out, [](const toml::node& n, T& o) { return get(n, o); });
  };
}

bool get(const toml::node& node, Quotient& out) {
  const auto* table = node.as_table();
  return table != nullptr && TableReader(*table, "")
                                 .read({{"multiply", quotient_list_into(out.multiply)},
                                        {"divide", quotient_list_into(out.divide)},
                                        {"power_of_two", into(out.power_of_two)},
                                        {"learned", into(out.learned)},
                                        {"when", quotient_list_into(out.when)},
                                        {"assumed", into(out.assumed)}})
                                 .has_value();
}

/// One quotient, or a list of those that hold under different conditions.
TableReader::Handler quotients_into(Quotients& out) {
  return [&out](const toml::node& node) {
    if (node.is_array()) return quotient_list_into(out)(node) && !out.empty();
    out.assign(1, {});
    return get(node, out.front());
  };
}

bool get(const toml::node& node, LearnRules& out) {
  const auto least = [&out](const toml::node& n) {
    out.least = n.value<double>().value_or(0);
    return out.least >= 1;
  };
  return has_only(node, {"speed", "least"}) &&
         TableReader(*node.as_table(), "").read({{"speed", into(out.speed)}, {"least", least}}).has_value();
}

}  // namespace

Result<void> read_units(const TableReader& reader, Rules& rules) {
  const auto measure = [&rules](Measure of) {
    return [&rules, of](const toml::node& node) { return quotients_into(rules.units[of])(node); };
  };
  return reader.read({{"increments_per_turn", measure(Measure::increments_per_turn)},
                      {"pulses_per_turn", measure(Measure::pulses_per_turn)},
                      {"rated_torque", measure(Measure::rated_torque)},
                      {"learn", [&rules](const toml::node& node) { return get(node, rules.learn); }}});
}

}  // namespace servoctl::drive
