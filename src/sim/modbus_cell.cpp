#include "sim/modbus_cell.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "sim/cell_spec.hpp"

namespace servoctl::sim {
namespace {

constexpr std::string_view kModbusExample =
    "simulated drives on Modbus are written FAMILY@ADDRESS, for example ts@1,ts@2?state=FILE";

/// Longer than the usual timeout of 500 ms, and shorter than twice that.
constexpr Duration kLateAnswer = std::chrono::milliseconds(700);
constexpr std::string_view kModbusLies[] = {"late", "twice", "short", "unconfirmed", "busy"};

Result<void> add_modbus_lies(const CellSpec& spec, const CellSpec::Option& option, ModbusLies& lies) {
  const auto words = lies_of(spec, option, kModbusLies);
  if (!words) return fail(words.error());
  for (const auto word : *words) {
    if (word == "late") lies.late = true;
    if (word == "twice") lies.twice = true;
    if (word == "short") lies.is_short = true;
    if (word == "unconfirmed") lies.unconfirmed = true;
    if (word == "busy") lies.busy = true;
  }
  return {};
}

bool is_write(ByteSpan pdu) {
  return pdu[0] == static_cast<std::uint8_t>(modbus::Function::write_register) ||
         pdu[0] == static_cast<std::uint8_t>(modbus::Function::write_registers);
}

Result<void> apply_modbus_option(const CellSpec& spec, const CellSpec::Option& option, ModbusCell& cell,
                                 TimePoint now) {
  if (option.key == "state") return {};
  std::vector<DriveModel*> models;
  for (const auto& unit : cell.units) models.push_back(&unit->model());
  const auto is_applied = apply_drive_option(spec, option, models, now);
  if (!is_applied) return fail(is_applied.error());
  if (*is_applied) return {};
  if (option.key == "lie") return add_modbus_lies(spec, option, cell.lies);
  if (option.key == "damage") {
    const auto number = parse_digits(option.value, 10);
    if (!number || *number == 0 || *number > 1'000'000)
      return spec.wrong("damage=N damages every Nth answer: N is a number from 1 on");
    cell.damage = static_cast<unsigned>(*number);
    return {};
  }
  if (option.key != "silent" && option.key != "delay") {
    const std::string keys[] = {"state", "fault", "silent", "delay", "damage", "lie"};
    return spec.wrong(message("'{}' is not an option of simulated Modbus drives: use {}",
                              as_it_is(option.key), one_of(keys)));
  }
  const auto time = time_of(spec, option);
  if (!time) return fail(time.error());
  for (const auto& unit : cell.units) {
    if (option.key == "silent")
      unit->fall_silent_at(now + *time);
    else
      unit->set_delay(*time);
  }
  return {};
}

}  // namespace

std::optional<ModbusCell::Answer> ModbusCell::on_message(modbus::Framing framing,
                                                         const modbus::Message& message, TimePoint now) {
  const bool to_all = message.unit == modbus::kToAll;
  std::optional<Answer> out;
  for (const auto& unit : units) {
    if (!to_all && unit->unit() != message.unit) continue;
    const bool busy = lies.busy && answered % 3 != 2 && !to_all;
    auto pdu = busy ? modbus::exception_answer(message.pdu.front(), modbus::Exception::device_busy)
                    : unit->on_request(message.pdu, to_all, now);
    if (!pdu || out) continue;
    if (lies.unconfirmed && is_write(*pdu)) continue;
    if (lies.is_short) pdu->pop_back();
    out = Answer{modbus::frame(framing, {message.unit, message.transaction, std::move(*pdu)}),
                 now + unit->delay()};
  }
  if (!out) return out;
  if (lies.late && answered % 2 == 0) out->time += kLateAnswer;
  last_answer = out->time = std::max(out->time, last_answer);
  ++answered;
  if (damage != 0 && answered % damage == 0) out->bytes.back() ^= 0x10U;
  if (lies.twice) {
    const auto copy = out->bytes;
    out->bytes.insert(out->bytes.end(), copy.begin(), copy.end());
  }
  return out;
}

void ModbusCell::on_time(TimePoint now) {
  for (const auto& unit : units) {
    unit->model().set_time(now);
    if (unit->model().deadline() <= now) unit->model().on_time(now);
  }
}

TimePoint ModbusCell::deadline() const {
  auto next = kNever;
  for (const auto& unit : units) next = std::min(next, unit->model().deadline());
  return next;
}

Result<ModbusCell> build_modbus_cell(std::string_view text, std::span<const std::filesystem::path> folders,
                                     TimePoint now) {
  const auto spec = parse_cell_spec(text, kModbusExample);
  if (!spec) return fail(spec.error());
  ModbusCell cell;
  auto memory = open_memory(*spec);
  if (!memory) return fail(memory.error());
  cell.memory = std::move(*memory);
  for (const auto& place : spec->places) {
    const auto profile = profile_of(cell.profiles, place.family, folders);
    if (!profile) return fail(profile.error());
    if (!(*profile)->rules.modbus.exists())
      return fail(Errc::usage,
                  message("{} has no Modbus: the rules of this family have no [modbus] section",
                          as_it_is(place.family)),
                  message("put it on a simulated CAN bus: sim:{}@{}", as_it_is(place.family), place.node));
    const auto taken = [&](const auto& unit) { return unit->unit() == place.node; };
    if (std::any_of(cell.units.begin(), cell.units.end(), taken))
      return spec->wrong(message("address {} is given twice", place.node));
    const auto key = formatted("{}.{}", cell.units.size() + 1, place.family);
    cell.units.push_back(std::make_unique<ModbusUnit>(**profile, place.node, *cell.memory, key));
    cell.units.back()->power_on(now);
  }
  for (const auto& option : spec->options)
    if (const auto applied = apply_modbus_option(*spec, option, cell, now); !applied)
      return fail(applied.error());
  return cell;
}

}  // namespace servoctl::sim
