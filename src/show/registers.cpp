#include "show/registers.hpp"

#include "base/format.hpp"
#include "drive/naming.hpp"
#include "session/modbus_bits.hpp"
#include "session/modbus_network.hpp"
#include "show/fault_records.hpp"
#include "show/reading.hpp"

namespace servoctl::show {
namespace {

using report::List;
using report::Record;
using report::Show;
using report::Value;

Value family_of(const Desk& desk) { return desk.profile == nullptr ? Value() : Value(desk.profile->family); }

struct Alarm {
  Value text;
  Value code;
};

Alarm alarm_of(const Desk& desk, const Result<Bytes>& answer) {
  if (!answer) return {};
  const auto code = static_cast<std::uint16_t>(load_le(*answer));
  if (code == 0) return {Value("none"), Value(code)};
  return {Value(formatted("0x{:04X} {}", code, alarm_words(desk.profile, desk.chinese, code))), Value(code)};
}

/// What could not be read is told, and keeps nothing else from being shown.
void add_bits(Desk& desk, const Result<std::vector<bool>>& bits, std::string_view name, Record& out) {
  if (!bits) {
    desk.notices.push_back(bits.error().message);
    out.push_back({std::string(name), Value(), Show::json});
    return;
  }
  List numbers;
  std::string text;
  for (std::size_t i = 0; i < bits->size(); ++i) {
    numbers.emplace_back((*bits)[i]);
    if ((*bits)[i]) text += formatted("{}{}", text.empty() ? "" : ", ", i + 1);
  }
  out.push_back({std::string(name), text.empty() ? "none" : text, Show::text, formatted("{} on", name)});
  out.push_back({std::string(name), std::move(numbers), Show::json});
}

void add_parameters(Desk& desk, std::uint8_t node, Record& out) {
  std::vector<drive::Target> targets;
  std::vector<session::SdoRequest> requests;
  for (const auto& name : desk.profile->rules.modbus.shows)
    if (auto target = drive::resolve(desk.profile, name)) {
      requests.push_back({node, target->address, {}});
      targets.push_back(std::move(*target));
    }
  const auto answers = desk.session->transfer(requests);
  List records;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const auto& target = targets[i];
    const auto id = target.parameter != nullptr ? target.parameter->id : to_string(target.address);
    const auto title = desk.chinese ? target.label_zh() : target.label();
    if (!answers[i]) {
      out.push_back({id, answers[i].error().message.text(), Show::text, title});
      continue;
    }
    const auto decoded = decode_value({node, target, {}, Bytes{}}, *answers[i]);
    const auto* label = std::get_if<std::string>(&decoded.label.data());
    out.push_back({id, label == nullptr ? decoded.text : decoded.text + " " + *label, Show::text, title});
    records.emplace_back(Record{{"id", id},
                                {"value", decoded.value},
                                {"unit", report::text_or_null(decoded.unit)},
                                {"label", decoded.label}});
  }
  out.push_back({"parameters", std::move(records), Show::json});
}

}  // namespace

report::Table register_scan(Desk& desk, std::span<const session::Identity> found) {
  report::Table table;
  table.columns = {{"node"}, {"family"}, {"alarm_text", "alarm", Show::text}, {"alarm", "", Show::json}};
  const auto place = desk.profile == nullptr
                         ? std::nullopt
                         : drive::place_of(*desk.profile, desk.profile->rules.fault.alarm);
  std::vector<session::SdoRequest> requests;
  for (const auto& unit : found) {
    if (desk.profile != nullptr) desk.session->modbus()->learn(unit.node, desk.profile->rules.modbus);
    if (place) requests.push_back({unit.node, *place, {}});
  }
  const auto answers = desk.session->transfer(requests);
  for (std::size_t i = 0; i < found.size(); ++i) {
    auto alarm = place ? alarm_of(desk, answers[i]) : Alarm{};
    table.rows.push_back({found[i].node, family_of(desk), std::move(alarm.text), std::move(alarm.code)});
  }
  desk.notices.push_back(desk.profile == nullptr
                             ? "registers do not say what a device is: -d FAMILY says it, and shows its alarm"
                             : message("registers do not say what a device is: that these are {} was "
                                       "said with -d",
                                       as_it_is(desk.profile->family)));
  return table;
}

Result<Value> register_info(Desk& desk, std::uint8_t node) {
  const std::uint8_t nodes[] = {node};
  std::vector<Error> away;
  const auto found = session::scan(*desk.session, nodes, &away);
  if (!found) return fail(found.error());
  if (found->empty())
    return fail(away.empty() ? drive_error(Errc::timeout, node, "no answer") : away.front());
  Record out{{"node", node}, {"family", family_of(desk), Show::json}};
  if (desk.profile == nullptr) {
    out.push_back(
        {"family", "not known: registers do not say what a device is; -d FAMILY says it", Show::text});
    for (const auto* key : {"parameters", "inputs", "outputs"}) out.push_back({key, Value(), Show::json});
    return Value(std::move(out));
  }
  const auto& rules = desk.profile->rules;
  out.push_back(
      {"family",
       formatted("{} ({} {}), as you said: registers do not say what a device is", desk.profile->family,
                 rules.vendor, desk.chinese && !rules.name_zh.empty() ? rules.name_zh : rules.name),
       Show::text});
  add_parameters(desk, node, out);
  const auto& modbus = rules.modbus;
  if (modbus.inputs > 0)
    add_bits(desk, session::read_inputs(*desk.session, node, modbus.inputs), "inputs", out);
  else
    out.push_back({"inputs", Value(), Show::json});
  if (modbus.outputs > 0)
    add_bits(desk, session::read_outputs(*desk.session, node, modbus.outputs), "outputs", out);
  else
    out.push_back({"outputs", Value(), Show::json});
  return Value(std::move(out));
}

}  // namespace servoctl::show
