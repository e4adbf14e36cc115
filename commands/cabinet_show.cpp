#include <fmt/format.h>
#include <algorithm>
#include <map>

#include "base/number.hpp"
#include "base/text.hpp"
#include "cabinet/axis_states.hpp"
#include "can/descriptor.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
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

constexpr Parameter kParameters[] = {
    {.name = "axes", .help = "axes or groups: feeder,lift (default: all)"},
    {.name = "--watch", .help = "look again and again, until q or Ctrl-C", .kind = Kind::flag},
    kForOption,
};

std::string state_text(const AxisState& look, bool chinese) {
  if (look.error) return look.error->code == Errc::timeout ? "no answer" : "not reached";
  if (!look.state) return "-";
  return std::string(chinese ? drive::name_zh(*look.state) : drive::name(*look.state));
}

std::string mode_text(const AxisState& look) {
  if (!look.mode) return "-";
  const auto word = drive::mode_abbreviation(*look.mode);
  return word.empty() ? fmt::format("{}", *look.mode) : std::string(word);
}

std::string fault_text(const AxisState& look) {
  if (!look.fault) return "-";
  constexpr std::size_t kWords = 26;
  return *look.fault == 0 ? "none" : fmt::format("0x{:04X} {}", *look.fault, clip(look.fault_text, kWords));
}

std::string position_text(const AxisState& look) {
  return look.position ? fmt::format("{} {}", number_text(look.position->value), look.position->unit) : "-";
}

Value or_null(const auto& optional) { return optional ? Value(*optional) : Value(); }

Record record_of(const AxisState& look) {
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
          {"fault_text", report::text_or_null(look.fault_text)},
          {"position", position},
          {"error", look.error ? show::error_record(*look.error) : Value()}};
}

report::Table table_of(const std::vector<AxisState>& looks, bool chinese) {
  report::Table out;
  out.columns = {{"axis"},  {"bus"},  {"node"},  {"family"},  {"network"},
                 {"state"}, {"mode"}, {"fault"}, {"position"}};
  for (const auto& look : looks) {
    const auto shown = [](std::string text) { return text == "-" ? Value() : Value(std::move(text)); };
    out.rows.push_back({look.axis->name, look.axis->bus, look.axis->node, look.axis->family,
                        report::text_or_null(look.network), state_text(look, chinese), shown(mode_text(look)),
                        shown(fault_text(look)), shown(position_text(look))});
    out.documents.emplace_back(record_of(look));
  }
  return out;
}

/// Shows look after look: in place on a terminal, else a line for each axis that has changed.
class Watching {
 public:
  explicit Watching(Context& context)
      : context_(&context),
        view_(context.open_view({.columns = {{.title = "axis"},
                                             {.title = "node", .right = true},
                                             {.title = "family"},
                                             {.title = "state"},
                                             {.title = "mode"},
                                             {.title = "fault"},
                                             {.title = "position", .right = true}},
                                 .plots = false,
                                 .alternate_screen = true})) {}

  bool is_over() const { return context_->audience_is_gone() || (view_ && view_->is_over()); }
  void refresh(TimePoint now) {
    if (view_) view_->refresh(now);
  }

  void take(const std::vector<AxisState>& looks, double seconds) {
    for (const auto& look : looks) {
      if (view_)
        view_->set(look.axis->name, {look.axis->name, fmt::format("{}", look.axis->node), look.axis->family,
                                     state_text(look, context_->chinese), mode_text(look), fault_text(look),
                                     position_text(look)});
      else
        take_line(look, seconds);
    }
  }

 private:
  /// A position changes all the time: it is told with what else changes.
  void take_line(const AxisState& look, double seconds) {
    auto text = fmt::format("{}  {}  {}  {}", look.network.empty() ? "-" : look.network,
                            state_text(look, context_->chinese), mode_text(look), fault_text(look));
    auto& before = lines_[look.axis];
    if (text == before) return;
    before = text;
    Record record{{"time", seconds}};
    for (auto& field : record_of(look)) record.push_back(std::move(field));
    context_->emit(record,
                   fmt::format("{:8.3f} s  {}  {}  {}", seconds, look.axis->name, text, position_text(look)));
  }

  Context* context_;
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
bool pause(session::Session* session, Watching& watching) {
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

Result<Value> run(Context& context, const Arguments& arguments) {
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
  if (arguments.has("--watch")) {
    Watching watching(context);
    const auto begin = steady_now();
    for (;;) {
      const auto since = steady_now() - begin;
      watching.take(now, std::chrono::duration<double>(since).count());
      if ((*length && since >= **length) || !pause(last, watching)) break;
      auto next = looks.look();
      if (was_interrupted(next)) break;
      now = std::move(next);
    }
  }
  for (const auto& look : now)
    if (look.error) context.errors.push_back(*look.error);
  return Value(table_of(now, context.chinese));
}

}  // namespace

extern const Command kCabinetShow;
const Command kCabinetShow{
    .path = "cabinet show",
    .summary = "Show every axis of the cabinet, one line each",
    .details =
        "Axis, node, family, NMT or AL state, drive state, mode, fault, and position, which is of the load "
        "where the file says what that moves. --watch looks four times a second: on a terminal a table that "
        "is updated where it stands (space pauses, s sorts, q ends), in a pipe a line for each axis "
        "whose state changed. A bus that is lost is opened again. Drives are only read.",
    .parameters = kParameters,
    .needs = Needs::nothing,
    .effect = Effect::reads,
    .family = FamilyCheck::never,
    .run = run,
};

}  // namespace servoctl::commands
