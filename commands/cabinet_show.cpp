#include <algorithm>
#include <map>
#include <set>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "cabinet/axis_states.hpp"
#include "cabinet/cabinet_plan.hpp"
#include "can/descriptor.hpp"
#include "command/cabinet_options.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "report/table_text.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using cabinet::AxisState;
using report::Record;
using report::Show;
using report::Value;

/// Four looks a second.
constexpr Duration kPause = std::chrono::milliseconds(250);

constexpr Parameter kCabinetShowParameters[] = {
    {.name = "axes", .help = "axes or groups: feeder,lift (default: all)"},
    {.name = "--watch", .help = "look again and again, until q or Ctrl-C", .kind = Kind::flag},
    kForOption,
};

std::string state_text(const AxisState& look, bool chinese) {
  if (look.error) return look.error->code == Errc::timeout ? "no answer" : "not reached";
  if (!look.state) return "-";
  return std::string(chinese ? drive::name_zh(*look.state) : drive::name(*look.state));
}

std::string axis_mode_text(const AxisState& look) {
  if (!look.mode) return "-";
  return look.mode_word.empty() ? formatted("{}", *look.mode) : look.mode_word;
}

std::string fault_text(const AxisState& look, std::size_t columns = std::string::npos) {
  const auto cell = look.told_fault.cell(columns);
  const auto* text = std::get_if<std::string>(&cell.data());
  return text == nullptr ? "-" : *text;
}

std::string position_text(const AxisState& look) {
  return look.position ? formatted("{} {}", number_text(look.position->value), look.position->unit) : "-";
}

/// Of a table that has 80 columns: the words of CAN are long.
std::string network_text(const AxisState& look) {
  if (look.network == session::name(session::NodeState::pre_operational)) return "pre-op";
  if (look.network == session::name(session::NodeState::operational)) return "op";
  return look.network.empty() ? "-" : look.network;
}

/// How many values of each axis are not as the file says. Read more rarely than the rest: it is what `cabinet
/// plan` reads.
class Differences {
 public:
  Differences(Context& context, const cabinet::Cabinet& cabinet)
      : context_(&context), cabinet_(&cabinet), families_(drive::find_families(context.drive_folders)) {}

  /// Of the axes that answered just now, if that is due.
  void read(const std::vector<AxisState>& looks) {
    constexpr Duration kEvery = std::chrono::seconds(5);
    const auto now = steady_now();
    if (read_at_ && now < *read_at_ + kEvery) return;
    read_at_ = now;
    found_.clear();
    waiting_.clear();
    std::vector<cabinet::Station> stations;
    for (const auto& look : looks)
      if (!look.error) stations.push_back(open_station(*context_, *cabinet_, *look.axis));
    const cabinet::PlanChoice choice{.unlisted = false, .families = families_};
    for (const auto& look : cabinet::look_at_all(*context_, *cabinet_, stations, choice)) {
      if (look.plan)
        take(look);
      else
        tell(*look.axis, look.plan.error());
    }
  }

  /// Whether values of the axis wait for a restart.
  bool waits(const AxisState& look) const { return waiting_.count(look.axis) > 0; }
  report::List owed(const AxisState& look) const {
    const auto found = waiting_.find(look.axis);
    return found == waiting_.end() ? report::List() : found->second;
  }

  /// Empty: not known.
  std::optional<std::size_t> of(const AxisState& look) const {
    const auto found = found_.find(look.axis);
    return look.error || found == found_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  void take(const cabinet::PlannedAxis& look) {
    found_[look.axis] = look.plan->different;
    if (!look.waits_for_restart()) return;
    report::List names;
    for (const auto& name : look.plan->owed) names.emplace_back(name);
    waiting_[look.axis] = std::move(names);
    for (const auto& notice : look.notices)
      if (auto text = cabinet::of_axis(*look.axis, notice); told_.insert(text.text()).second)
        context_->notices.push_back(std::move(text));
  }

  /// Why an axis is not held against the file: it may be another drive.
  void tell(const cabinet::Axis& axis, const Error& error) {
    auto text = message("axis {}: {}", as_it_is(axis.name), error.message);
    if (told_.insert(text.text()).second) context_->notices.push_back(std::move(text));
  }

  Context* context_;
  const cabinet::Cabinet* cabinet_;
  std::set<std::string> told_;
  std::vector<drive::Family> families_;
  std::optional<TimePoint> read_at_;
  std::map<const cabinet::Axis*, std::size_t> found_;
  std::map<const cabinet::Axis*, report::List> waiting_;  ///< Parameters that wait for a restart.
};

Value or_null(const auto& optional) { return optional ? Value(*optional) : Value(); }

/// `0`, `2`, `0 restart`.
Value differ_cell(const AxisState& look, const Differences& differences) {
  const auto different = differences.of(look);
  if (!different || !differences.waits(look)) return or_null(different);
  return formatted("{} restart", *different);
}

Record axis_record(const AxisState& look, const Differences& differences) {
  const auto position =
      look.position ? Value(Record{{"value", look.position->value}, {"unit", look.position->unit}}) : Value();
  return {{"axis", look.axis->name},
          {"bus", look.axis->bus},
          {"node", look.axis->node},
          {"family", look.axis->family},
          {"network", report::text_or_null(look.network)},
          {"state", look.state ? Value(drive::name(*look.state)) : Value()},
          {"energised", look.state ? Value(drive::is_energised(*look.state)) : Value()},
          {"mode", or_null(look.mode)},
          {"fault", or_null(look.fault)},
          {"fault_text", report::text_or_null(look.told_fault.text)},
          {"position", position},
          {"different", or_null(differences.of(look))},
          {"restart_owed", differences.owed(look)},
          {"error", look.error ? show::error_record(*look.error) : Value()}};
}

report::Table axes_table(const std::vector<AxisState>& looks, const Differences& differences, bool chinese,
                         std::size_t window) {
  report::Table out;
  const auto shown = [](std::string text) { return text == "-" ? Value() : Value(std::move(text)); };
  out.columns = {{"axis"},  {"bus"},  {"node"},  {"family"},   {"network"},
                 {"state"}, {"mode"}, {"fault"}, {"position"}, {"different", "differ"}};
  for (const auto& look : looks) {
    out.rows.push_back({look.axis->name, look.axis->bus, look.axis->node, look.axis->family,
                        shown(network_text(look)), state_text(look, chinese), shown(axis_mode_text(look)),
                        Value(), shown(position_text(look)), differ_cell(look, differences)});
    out.documents.emplace_back(axis_record(look, differences));
  }
  constexpr std::size_t kFault = 7;
  constexpr std::size_t kLeast = 26;
  constexpr std::size_t kNumber = 7;  // `0x2310 `
  const auto left = report::room_for(out, kFault, window);
  const auto room = window == 0 ? left : std::max(kLeast, left - std::min(left, kNumber));
  for (std::size_t i = 0; i < looks.size(); ++i) out.rows[i][kFault] = shown(fault_text(looks[i], room));
  return out;
}

/// Shows look after look: in place on a terminal, else a line for each axis that has changed.
class WatchingAxes {
 public:
  WatchingAxes(Context& context, const Differences& differences)
      : context_(&context),
        differences_(&differences),
        view_(context.open_view({.columns = {{.title = "axis"},
                                             {.title = "node", .right = true},
                                             {.title = "network"},
                                             {.title = "state"},
                                             {.title = "mode"},
                                             {.title = "fault"},
                                             {.title = "position", .right = true},
                                             {.title = "differ", .right = true}},
                                 .plots = false,
                                 .alternate_screen = true})) {}

  bool is_over() const { return context_->audience_is_gone() || (view_ && view_->is_over()); }
  void refresh(TimePoint now) {
    if (view_) view_->refresh(now);
  }

  void take(const std::vector<AxisState>& looks, double seconds) {
    for (const auto& look : looks) {
      if (view_)
        view_->set(look.axis->name, {look.axis->name, formatted("{}", look.axis->node), network_text(look),
                                     state_text(look, context_->chinese), axis_mode_text(look),
                                     fault_text(look), position_text(look), differ_text(look)});
      else
        take_line(look, seconds);
    }
  }

 private:
  std::string differ_text(const AxisState& look) const {
    const auto different = differences_->of(look);
    if (!different) return "-";
    return differences_->waits(look) ? formatted("{} restart", *different) : formatted("{}", *different);
  }

  /// A position changes all the time: it is told with what else changes.
  void take_line(const AxisState& look, double seconds) {
    auto text = formatted("{}  {}  {}  {}", network_text(look), state_text(look, context_->chinese),
                          axis_mode_text(look), fault_text(look));
    if (const auto different = differences_->of(look); different.value_or(0) > 0)
      text += formatted("  {} differ", *different);
    if (differences_->waits(look)) text += "  restart";
    auto& before = lines_[look.axis];
    if (text == before) return;
    before = text;
    Record record{{"time", seconds}};
    for (auto& field : axis_record(look, *differences_)) record.push_back(std::move(field));
    context_->emit(record,
                   formatted("{:8.3f} s  {}  {}  {}", seconds, look.axis->name, text, position_text(look)));
  }

  Context* context_;
  const Differences* differences_;
  std::unique_ptr<show::LiveView> view_;
  std::map<const cabinet::Axis*, std::string> lines_;
};

/// Ctrl-C in the middle of a look: what was seen last stands.
bool was_interrupted(const std::vector<AxisState>& looks) {
  return std::any_of(looks.begin(), looks.end(), [](const AxisState& look) {
    return look.error && look.error->code == Errc::interrupted;
  });
}

/// Until the next look; false when the user wants an end.
bool pause(session::Session* session, WatchingAxes& watching) {
  const auto end = steady_now() + kPause;
  constexpr Duration kSlice = std::chrono::milliseconds(50);
  while (steady_now() < end && !watching.is_over()) {
    watching.refresh(steady_now());
    if (session == nullptr) {
      can::nap(kSlice);
      continue;
    }
    const auto waited = session->wait([] { return false; }, session->now() + kSlice);
    if (!waited && waited.error().code == Errc::interrupted) return false;
    if (!waited) can::nap(kSlice);
  }
  return !watching.is_over();
}

Result<Value> run_cabinet_show(Context& context, const Arguments& arguments) {
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  const auto cabinet = context.front_end->cabinet();
  if (!cabinet) return fail(cabinet.error());
  const auto named = arguments.text("axes");
  auto axes = (*cabinet)->select(named.empty() ? "all" : named);
  if (!axes) return fail(axes.error());
  session::Session* last = nullptr;
  const auto open = [&](const cabinet::Bus& bus) {
    auto opened = context.front_end->open_bus(**cabinet, bus);
    last = opened ? *opened : nullptr;
    return opened;
  };
  cabinet::AxisStates looks(
      **cabinet, std::move(*axes), open,
      [&](const std::string& family) { return context.front_end->family(family); }, context);
  auto now = looks.look();
  Differences differences(context, **cabinet);
  differences.read(now);
  if (arguments.has("--watch")) {
    WatchingAxes watching(context, differences);
    const auto begin = steady_now();
    for (;;) {
      const auto since = steady_now() - begin;
      watching.take(now, std::chrono::duration<double>(since).count());
      if ((*length && since >= **length) || !pause(last, watching)) break;
      auto next = looks.look();
      if (was_interrupted(next)) break;
      now = std::move(next);
      differences.read(now);
    }
  }
  const auto window = context.audience == nullptr ? 0 : context.audience->width();
  for (const auto& look : now)
    if (look.error) context.errors.push_back(*look.error);
  return Value(axes_table(now, differences, context.chinese, window));
}

constexpr Example kCabinetShowExamples[] = {
    {"cabinet show", "state, fault and position of all axes"},
    {"cabinet show feeder,lift --watch", "of two, again and again until q"},
};

}  // namespace

extern const Command kCabinetShow;
const Command kCabinetShow{
    .path = "cabinet show",
    .summary = "Show every axis of the cabinet, one line each",
    .details =
        "Axis, node, family, NMT or AL state, drive state, mode, fault, and position, which is of the load "
        "where the file says what that moves, and how many values are not as the file says (`cabinet plan` "
        "names them). --watch looks four times a second: on a terminal a table that "
        "is updated where it stands (space pauses, s sorts, q ends), in a pipe a line for each axis "
        "whose state changed; what differs is read every five seconds. A bus that is lost is opened again. Drives are only read.",
    .parameters = kCabinetShowParameters,
    .examples = kCabinetShowExamples,
    .needs = Needs::nothing,
    .effect = Effect::reads,
    .family = FamilyCheck::never,
    .run = run_cabinet_show,
};

}  // namespace servoctl::commands
