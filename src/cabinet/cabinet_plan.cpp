#include "cabinet/cabinet_plan.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <map>

#include "base/format.hpp"
#include "base/text.hpp"
#include "session/identify.hpp"
#include "settings/interrupted_restore.hpp"
#include "show/axis_names.hpp"
#include "show/records.hpp"

namespace servoctl::cabinet {
namespace {

using report::List;
using report::Record;
using report::Show;
using report::Table;
using report::Value;

bool is_cut_off(const Cabinet& cabinet, const Axis& axis) {
  std::error_code ignored;
  const auto names = settings::before_names(before_file(cabinet, axis));
  return std::any_of(names.begin(), names.end(), [&](const auto& before) {
    return std::filesystem::exists(settings::journal_of(before), ignored);
  });
}

Result<settings::BeforeFile> find_before(const show::Desk& desk, const Cabinet& cabinet, const Axis& axis,
                                         const session::Identity& drive) {
  return settings::BeforeFile::find(desk, before_file(cabinet, axis), as_it_is(cabinet.file.string()), drive);
}

Result<AxisPlan> plan_anew(show::Desk& desk, const Cabinet& cabinet, const Axis& axis,
                           const PlanChoice& choice) {
  auto plan = plan_axis(desk, cabinet, axis, choice);
  if (!plan) return plan;
  const auto before = find_before(desk, cabinet, axis, plan->identity);
  if (!before) return fail(before.error());
  plan->before = before->path();
  return plan;
}

Result<AxisPlan> plan_rest(show::Desk& desk, const Cabinet& cabinet, const Axis& axis,
                           const PlanChoice& choice, const settings::BeforeFile& before) {
  auto wanted = settings::read_backup(wanted_file(cabinet, axis, before.path()));
  if (!wanted) return fail(wanted.error());
  // It is what a file says, not what a drive held.
  wanted->proven = false;
  auto all = choice;
  all.only.clear();
  all.unlisted = false;
  auto plan = plan_axis(desk, cabinet, axis, std::move(*wanted), all);
  if (plan) plan->before = before.path();
  return plan;
}

Error interrupted(const Axis& axis, const std::filesystem::path& before) {
  return drive_error(Errc::refused, axis.node, "an apply was interrupted",
                     message("`cabinet apply --resume` continues it; `restore {} -n {}` restores the old "
                             "values",
                             as_it_is(before.string()), as_it_is(axis.name)));
}

/// Looks for a journal first: what an axis holds in the middle of a change is no basis for another.
Result<AxisPlan> look_at(show::Desk& desk, const Cabinet& cabinet, const Axis& axis, const PlanChoice& choice,
                         bool resume) {
  if (!is_cut_off(cabinet, axis)) return plan_anew(desk, cabinet, axis, choice);
  const auto drive = session::read_identity(*desk.session, axis.node);
  // Of which drive it is cannot be asked: nothing is begun anew.
  if (!drive) return fail(resume ? drive.error() : interrupted(axis, before_file(cabinet, axis)));
  const auto before = find_before(desk, cabinet, axis, *drive);
  if (!before) return fail(before.error());
  const auto journal = settings::read_journal(desk, before->journal());
  if (!journal) return fail(journal.error());
  if (!*journal && resume)
    return fail(settings::nothing_to_resume(*before, as_it_is(cabinet.file.string()), axis.node));
  if (!*journal) return plan_anew(desk, cabinet, axis, choice);
  return resume ? plan_rest(desk, cabinet, axis, choice, *before)
                : Result<AxisPlan>(fail(interrupted(axis, before->path())));
}

/// The axes of one session whose PDOs change, held against each other and those who share the bus: the one
/// that is at fault is taken out, until the others fit.
void check_bus(const show::Desk& line, const Station& of, std::vector<PlannedAxis*> changing) {
  while (!changing.empty()) {
    std::vector<pdo::PdoNeighbour> nodes;
    for (const auto* look : changing)
      nodes.push_back({look->axis->node, look->plan->pdos_before, look->plan->pdos_after});
    auto desk = desk_at(line, of);
    const auto fits = pdo::check_neighbours(desk, nodes);
    for (auto& notice : desk.notices) changing.front()->notices.push_back(std::move(notice));
    if (fits) return;
    const auto at_fault = std::find_if(changing.begin(), changing.end(), [&](const PlannedAxis* look) {
      return look->axis->node == fits.error().node;
    });
    auto* const look = at_fault != changing.end() ? *at_fault : changing.front();
    look->plan = fail(fits.error());
    std::erase(changing, look);
  }
}

void check_buses(const show::Desk& desk, std::span<const Station> stations, std::vector<PlannedAxis>& looks) {
  std::map<session::Session*, std::vector<PlannedAxis*>> changing;
  std::map<session::Session*, const Station*> first;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (!looks[i].plan || looks[i].plan->pdos_after.empty()) continue;
    changing[stations[i].session].push_back(&looks[i]);
    first.emplace(stations[i].session, &stations[i]);
  }
  for (auto& [session, of_it] : changing) check_bus(desk, *first.at(session), std::move(of_it));
}

std::string title_of(const Axis& axis) {
  return formatted("{}, node {}, {}", axis.name, axis.node, axis.family);
}

Value needs_value(const AxisPlan& plan) {
  List out;
  for (const auto& need : plan.needs) {
    List names;
    for (const auto& each : need.names) names.emplace_back(each);
    out.emplace_back(Record{{"need", name(need.kind)}, {"parameters", std::move(names)}});
  }
  return Value(std::move(out));
}

/// A table as JSON has it; an empty list where there is none.
Value rows_or_none(const Value& table) { return table.is_null() ? Value(List()) : table; }

Record json_of(const PlannedAxis& look) {
  Record out{{"axis", look.axis->name},
             {"bus", look.axis->bus},
             {"node", look.axis->node},
             {"family", look.axis->family}};
  if (!look.plan) {
    for (const auto* key : {"serial", "compared", "differences", "unlisted", "needs"}) out.push_back({key});
    out.push_back({"error", show::error_record(look.plan.error())});
    return out;
  }
  out.push_back({"serial", look.plan->identity.serial ? Value(*look.plan->identity.serial) : Value()});
  out.push_back({"compared", look.plan->compared});
  out.push_back({"differences", rows_or_none(look.plan->differences)});
  out.push_back({"unlisted", rows_or_none(look.plan->unlisted)});
  out.push_back({"needs", needs_value(*look.plan)});
  out.push_back({"error", Value()});
  return out;
}

/// Its differences, and below them what they ask for.
void add_text(const PlannedAxis& look, Record& out) {
  const auto title = title_of(*look.axis);
  if (!look.plan) {
    out.push_back({look.axis->name, "not known; see the error", Show::text, title});
    return;
  }
  if (look.plan->different == 0) {
    out.push_back({look.axis->name,
                   look.plan->owed.empty() ? "nothing to do"
                                           : formatted("nothing to write; needs a restart ({})",
                                                       fmt::join(look.plan->owed, ", ")),
                   Show::text, title});
  } else if (const auto* table = look.plan->differences.table()) {
    auto shown = *table;
    for (const auto& need : look.plan->needs) shown.below.push_back(sentence(need));
    out.push_back({look.axis->name, std::move(shown), Show::text, title});
  }
  if (!look.plan->unlisted.is_null())
    out.push_back({look.axis->name, look.plan->unlisted, Show::text,
                   formatted("{}: not in the file, and not as the factory left it", look.axis->name)});
}

std::size_t axes_to_do(std::span<const PlannedAxis> looks) {
  return static_cast<std::size_t>(
      std::count_if(looks.begin(), looks.end(), [](const auto& look) { return look.to_do(); }));
}

std::size_t values_to_do(std::span<const PlannedAxis> looks) {
  std::size_t out = 0;
  for (const auto& look : looks)
    if (look.plan) out += look.plan->different;
  return out;
}

std::string count_text(std::size_t count, std::string_view one, std::string_view many) {
  return formatted("{} {}", count, count == 1 ? one : many);
}

std::string differing(std::span<const PlannedAxis> looks) {
  const auto values = values_to_do(looks);
  const auto axes = axes_to_do(looks);
  if (values == 1) return "1 value of 1 axis";
  return axes == 1 ? formatted("{} values of 1 axis", values)
                   : formatted("{} values of {} axes", values, axes);
}

std::string to_do_text(std::span<const PlannedAxis> looks) {
  const auto unknown = std::count_if(looks.begin(), looks.end(), [](const auto& look) { return !look.plan; });
  auto out = axes_to_do(looks) > 0 ? differing(looks) : unknown == 0 ? std::string("nothing") : std::string();
  if (unknown > 0)
    append(out, "not known of " + count_text(static_cast<std::size_t>(unknown), "axis", "axes"));
  return out;
}

}  // namespace

std::filesystem::path before_file(const Cabinet& cabinet, const Axis& axis) {
  return formatted("{}.before-{}.json", cabinet.file.string(), axis.name);
}

std::filesystem::path wanted_file(const Cabinet& cabinet, const Axis& axis,
                                  const std::filesystem::path& before) {
  const auto usual = before_file(cabinet, axis).stem().string();
  return formatted("{}.wanted-{}{}", cabinet.file.string(), axis.name,
                   before.filename().string().substr(usual.size()));
}

std::vector<PlannedAxis> look_at_all(const show::Desk& desk, const Cabinet& cabinet,
                                     std::span<const Station> stations, const PlanChoice& choice,
                                     bool resume) {
  std::vector<PlannedAxis> out;
  std::vector<Station> looked_at;
  for (const auto& station : stations) {
    if (resume && !is_cut_off(cabinet, *station.axis)) continue;
    looked_at.push_back(station);
    const auto why = station.away.value_or(make_error(Errc::interrupted, "not looked at"));
    out.push_back({station.axis, fail(why), {}});
  }
  at_all(looked_at, [&](std::size_t i) {
    auto at = desk_at(desk, looked_at[i]);
    out[i].plan = look_at(at, cabinet, *looked_at[i].axis, choice, resume);
    out[i].notices = std::move(at.notices);
  });
  check_buses(desk, looked_at, out);
  return out;
}

Record plan_record(const Cabinet& cabinet, std::span<const PlannedAxis> looks) {
  Record out{{"cabinet", cabinet.file.string(), Show::json}, {"to do", to_do_text(looks), Show::text}};
  List axes;
  for (const auto& look : looks) {
    add_text(look, out);
    axes.emplace_back(json_of(look));
  }
  out.push_back({"axes", std::move(axes), Show::json});
  out.push_back({"different", values_to_do(looks), Show::json});
  return out;
}

Message of_axis(const Axis& axis, const Message& notice) {
  const show::AxisNames names({{axis.node, axis.name}});
  auto named = notice;
  names.put_into(named);
  return named.names(axis.name) ? named : message("axis {}: {}", Verbatim{axis.name}, named);
}

Error of_axis(const Axis& axis, Error error) {
  error.message = of_axis(axis, error.message);
  show::AxisNames({{axis.node, axis.name}}).put_into(error.hint);
  if (!error.node) error.node = axis.node;
  return error;
}

void tell_looks(show::Desk& desk, std::span<const PlannedAxis> looks) {
  for (const auto& look : looks) {
    for (const auto& notice : look.notices) desk.notices.push_back(of_axis(*look.axis, notice));
    if (!look.plan) desk.errors.push_back(of_axis(*look.axis, look.plan.error()));
  }
}

bool any_to_do(std::span<const PlannedAxis> looks) {
  return std::any_of(looks.begin(), looks.end(),
                     [](const auto& look) { return look.to_do() || look.waits_for_restart(); });
}

Error something_to_do(const Cabinet& cabinet, std::span<const PlannedAxis> looks) {
  if (axes_to_do(looks) == 0) {
    std::vector<std::string> waiting;
    for (const auto& look : looks)
      if (look.waits_for_restart()) waiting.push_back(look.axis->name);
    const auto names = formatted("{}", fmt::join(waiting, ","));
    return make_error(Errc::negative,
                      message("{}: values are stored and in force after a restart", NameList{waiting}),
                      message("restart the drives; `status -n {}` says how", as_it_is(names)));
  }
  return make_error(
      Errc::negative,
      values_to_do(looks) == 1
          ? message("{} differs from {}", differing(looks), as_it_is(cabinet.file.filename().string()))
          : message("{} differ from {}", differing(looks), as_it_is(cabinet.file.filename().string())),
      "`cabinet apply` writes them");
}

}  // namespace servoctl::cabinet
