// Lines that name axes of a cabinet: which buses and families they concern, and one outcome of all.
#include <algorithm>
#include <list>
#include <utility>
#include <variant>

#include "base/format.hpp"
#include "base/text.hpp"
#include "cabinet/station.hpp"
#include "cli/shell.hpp"
#include "session/gateway_network.hpp"
#include "session/open_bus.hpp"
#include "session/open_port.hpp"
#include "session/open_register_line.hpp"

namespace servoctl::cli {
namespace {

using cabinet::Cabinet;
using command::Effect;
using command::Needs;
using report::List;
using report::Table;
using report::Value;

/// Whether the parts are of several buses, and none of them asks: one question at a time. What may begin
/// process data goes bus by bus: behind a part that has ended its bus has to be served.
bool is_side_by_side(const command::Command& command, const command::Arguments& arguments,
                     const std::vector<LinePart>& parts) {
  const auto& first = parts.front().settings;
  const bool asks = command.effect_with(arguments) > Effect::writes && !first.yes;
  const bool begins_cycles = includes(command.needs, Needs::ethercat);
  if (asks || begins_cycles || command.opens_bus || !includes(command.needs, Needs::bus)) return false;
  return std::any_of(parts.begin(), parts.end(),
                     [&](const LinePart& part) { return part.settings.bus != first.bus; });
}

/// What changes drives on one bus and cannot be there on another changes none. A way out goes as far as it
/// can.
Result<void> check_wires(const command::Command& command, const std::vector<LinePart>& parts) {
  const bool frames = includes(command.needs, Needs::can);
  if (command.way_out || (!frames && !includes(command.needs, Needs::nmt))) return {};
  std::string left_out;
  std::string rest;
  for (const auto& part : parts) {
    const auto& bus = part.settings.bus;
    const bool is_can =
        !session::is_ethercat(bus) && !session::is_modbus(bus) && (!frames || !session::is_gateway(bus));
    for (const auto* axis : part.axes) append(is_can ? rest : left_out, axis->name, ",");
  }
  if (left_out.empty() || rest.empty()) return {};
  return fail(Errc::usage,
              message("'{}' needs CAN, and {} is not on CAN: nothing was done", as_it_is(command.path),
                      as_it_is(left_out)),
              message("name the others: -n {}", as_it_is(rest)));
}

/// Where nothing but the bus tells rows apart.
void put_bus_into(Value& value, const std::string& bus) {
  if (auto* record = std::get_if<report::Record>(&value.data()))
    record->insert(record->begin(), {"bus", bus});
  if (auto* list = std::get_if<List>(&value.data()))
    for (auto& one : *list) put_bus_into(one, bus);
  if (auto* table = value.table()) {
    table->columns.insert(table->columns.begin(), {"bus"});
    for (auto& row : table->rows) row.insert(row.begin(), bus);
    for (auto& document : table->documents) put_bus_into(document, bus);
  }
}

}  // namespace

/// One part of a line on its way.
struct Shell::PartRun {
  PartRun(Shell& shell, const ParsedLine& line, LinePart part)
      : arguments(line.arguments), of_bus(part.axes.empty()), run(shell, *line.command, std::move(part)) {
    from_file = add_axis_options(run.axes, *line.command, arguments);
    if (const auto ready = shell.make_ready(run, arguments); !ready) result = fail(ready.error());
  }
  void carry_out() { result = run.command->run(run.context, arguments); }

  /// Who did not type an option finds it where it was said.
  void name_file(Error& error) const {
    for (const auto& [option, key] : from_file) {
      if (!error.hint.says(formatted("{} ", option))) continue;
      auto where = message("; the cabinet file says it: `{}`", as_it_is(key));
      if (run.settings.shows_chinese()) report::put_into_chinese(where);
      error.hint += where;
    }
  }

  command::Arguments arguments;
  std::vector<OptionOfAxis> from_file;
  bool of_bus;
  Run run;
  std::optional<Result<Value>> result;
};

Outcome Shell::perform_parsed(const ParsedLine& line, const Settings& settings) {
  std::vector<Message> notices;
  auto out = perform_parts(line, settings, notices);
  out.notices.insert(out.notices.begin(), notices.begin(), notices.end());
  return out;
}

Outcome Shell::perform_parts(const ParsedLine& line, const Settings& settings,
                             std::vector<Message>& notices) {
  auto parts = parts_of_line(line, settings, notices);
  if (!parts) return failed(parts.error(), settings, line.command->path);
  if (parts->empty()) return perform_part(line, {settings, {}, {}});
  if (const auto right = check_parts(line, *parts); !right)
    return failed(right.error(), settings, line.command->path);
  const bool together = is_side_by_side(*line.command, line.arguments, *parts);
  const bool joins = line.command->joins && parts->size() > 1;
  auto outcomes = joins      ? perform_joined(line, std::move(*parts))
                  : together ? perform_side_by_side(line, std::move(*parts))
                             : perform_in_turn(line, std::move(*parts));
  if (outcomes.size() > 1) last_write_.give_up(*line.command, "it went to several buses or families");
  auto all = std::move(outcomes.front());
  for (std::size_t i = 1; i < outcomes.size(); ++i) add_outcome(all, std::move(outcomes[i]));
  return all;
}

/// What one family does not take is told before another one is written to.
Result<void> Shell::check_parts(const ParsedLine& line, const std::vector<LinePart>& parts) {
  const auto& command = *line.command;
  if (parts.size() < 2 || command.effect_with(line.arguments) < Effect::writes) return {};
  if (auto right = check_wires(command, parts); !right || !command.check) return right;
  for (const auto& part : parts) {
    if (part.settings.drive.empty()) continue;
    const auto family = profile(part.settings.drive);
    if (!family) return fail(family.error());
    command::Context context;
    context.profile = *family;
    context.chinese = part.settings.chinese;
    context.drive_folders = options_.drive_folders;
    for (const auto* axis : part.axes) context.nodes.push_back(axis->node);
    auto right = command.check(context, line.arguments);
    if (!right) {
      part.settings.names.put_into(right.error().message);
      return right;
    }
  }
  return {};
}

std::vector<Outcome> Shell::perform_in_turn(const ParsedLine& line, std::vector<LinePart> parts) {
  std::vector<Outcome> out;
  const bool several = parts.size() > 1;
  for (auto& part : parts) {
    const bool of_bus = part.axes.empty() && several;
    out.push_back(perform_part(line, std::move(part)));
    if (of_bus) put_bus_into(out.back().result, out.back().settings.bus);
    // A way out goes as far as it can.
    if (!cancelled() || line.command->way_out) continue;
    if (out.size() < parts.size() && out.back().errors.empty())
      out.back().errors.push_back(make_error(Errc::interrupted, "interrupted",
                                             "it was done on the buses above, and not on the others"));
    break;
  }
  return out;
}

/// All are made ready first, and what came of them is told at the end, one after the other; those of one bus
/// go one after the other too.
std::vector<Outcome> Shell::perform_side_by_side(const ParsedLine& line, std::vector<LinePart> parts) {
  std::list<PartRun> runs;
  for (auto& part : parts) runs.emplace_back(*this, line, std::move(part));
  std::vector<cabinet::Station> buses;
  for (auto& one : runs) {
    auto* const session = one.run.context.session;
    const bool known =
        std::any_of(buses.begin(), buses.end(), [&](const auto& bus) { return bus.session == session; });
    if (!one.result && !known) buses.push_back({nullptr, nullptr, session, {}});
  }
  cabinet::at_all(buses, [&](std::size_t i) {
    // The result of a part of another bus is its own thread's.
    for (auto& one : runs)
      if (one.run.context.session == buses[i].session && !one.result) one.carry_out();
  });
  progress_.end();
  std::vector<Outcome> out;
  for (auto& one : runs) {
    // What became of another part may have closed the bus.
    const auto open = bus_.sessions();
    if (std::find(open.begin(), open.end(), one.run.context.session) == open.end())
      one.run.context.session = nullptr;
    out.push_back(finish(one.run, *one.result));
    for (auto& error : out.back().errors) one.name_file(error);
    if (one.of_bus) put_bus_into(out.back().result, out.back().settings.bus);
  }
  return out;
}

/// One run for all parts. What cannot be made ready ends the line before anything is done.
std::vector<Outcome> Shell::perform_joined(const ParsedLine& line, std::vector<LinePart> parts) {
  std::list<PartRun> runs;
  std::vector<command::Context*> others;
  for (auto& part : parts) {
    runs.emplace_back(*this, line, std::move(part));
    if (runs.back().result) return {finish(runs.back().run, *runs.back().result)};
    if (runs.size() > 1) others.push_back(&runs.back().run.context);
  }
  auto& front = runs.front();
  front.run.context.others = others;
  front.carry_out();
  progress_.end();
  // A bus that was lost is the one of its own part.
  for (auto& one : runs)
    if (&one.run.context == front.run.context.failed)
      one.result = std::exchange(front.result, Result<Value>(Value()));
  std::vector<Outcome> out;
  for (auto& one : runs) out.push_back(finish(one.run, one.result ? *one.result : Result<Value>(Value())));
  return out;
}

Outcome Shell::perform_part(const ParsedLine& line, LinePart part) {
  PartRun one(*this, line, std::move(part));
  if (!one.result) {
    const auto* session = one.run.context.session;
    last_write_.look(*line.command, one.arguments, one.run.context, one.run.settings,
                     session == nullptr ? 0 : opening(*session));
    one.carry_out();
    last_write_.settle(one.run.context);
  }
  progress_.end();
  auto out = finish(one.run, *one.result);
  for (auto& error : out.errors) one.name_file(error);
  return out;
}

}  // namespace servoctl::cli
