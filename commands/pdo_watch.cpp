#include <fmt/format.h>
#include <algorithm>

#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "pdo/pdo_use.hpp"
#include "show/live_pdo.hpp"
#include "show/sample_writer.hpp"
#include "traffic/listening.hpp"
#include "traffic/rhythm_table.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Parameter kParameters[] = {
    {.name = "pdo",
     .help = "RPDO1, TPDO2 … (default: all that are in use)",
     .kind = Kind::text,
     .many = true},
    kForOption,
};

/// One PDO that is watched, and how often it came.
struct Watched {
  show::PdoView view;
  Rhythm rhythm = {};
};

/// The PDOs of all nodes that were asked for and are in use.
Result<std::vector<Watched>> pdos_of(Context& context, const Arguments& arguments) {
  std::vector<Watched> out;
  for (const auto node : context.nodes) {
    const auto views = pdo::read_views(context, node);
    if (!views) return fail(views.error());
    for (const auto& name : arguments.all("pdo")) {
      const auto view = pdo::find_view(*views, node, name);
      if (!view) return fail(view.error());
      if (!(*view)->pdo.is_valid())
        return fail(Errc::negative, fmt::format("node {}: {} is not in use", node, (*view)->name),
                    "bit 31 of its COB-ID is set; `pdo enable` clears it");
      out.push_back({**view});
    }
    if (arguments.has("pdo")) continue;
    for (const auto& view : *views)
      if (view.pdo.is_valid()) out.push_back({view});
  }
  return out;
}

report::Table summary(std::span<const Watched> watched) {
  report::Table table;
  table.columns = {{"node"}, {"pdo"}};
  for (auto& column : traffic::rhythm_columns()) table.columns.push_back(std::move(column));
  for (const auto& entry : watched) {
    report::List row{entry.view.node, entry.view.name};
    for (auto& cell : traffic::rhythm_cells(entry.rhythm)) row.push_back(std::move(cell));
    table.rows.push_back(std::move(row));
  }
  return table;
}

void show(Context& context, show::SampleWriter& writer, const Watched& entry, const can::Frame& frame,
          Duration time) {
  const auto& view = entry.view;
  const auto data = frame.payload();
  const auto seconds = std::chrono::duration<double>(time).count();
  if (writer.wants_records()) {
    return writer.add_record([&](report::JsonWriter& json) {
      json.member("time", seconds);
      json.member("node", view.node);
      json.member("pdo", view.name);
      json.member("bytes", to_hex(data));
      json.key("values");
      show::write_values(view, data, json);
    });
  }
  if (auto* live = writer.view()) return show::show_values(*live, view, data, context.chinese);
  auto line = fmt::format("{:11.6f} {:3} {} ", seconds, view.node, view.name);
  show::append_values(view, data, context.chinese, line);
  writer.add_line(line);
}

/// Why nothing came, on CAN.
void tell_silence(Context& context, std::span<const Watched> watched) {
  const bool silent = std::all_of(watched.begin(), watched.end(),
                                  [](const Watched& entry) { return entry.rhythm.count() == 0; });
  if (silent)
    context.notices.emplace_back(
        "no PDO came: nodes send them when operational (`nmt start`), synchronous ones at SYNC (`sync "
        "start`), others when a value changes or by their event timer");
  const bool on_request = std::any_of(watched.begin(), watched.end(), [](const Watched& entry) {
    const auto& pdo = entry.view.pdo;
    return pdo.direction == canopen::PdoDirection::transmit && (pdo.type == 252 || pdo.type == 253) &&
           entry.rhythm.count() == 0;
  });
  if (on_request)
    context.notices.emplace_back(
        "TPDOs of transmission types 252 and 253 are sent only on a remote frame; servoctl sends none");
}

Result<Value> run(Context& context, const Arguments& arguments) {
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  auto watched = pdos_of(context, arguments);
  if (!watched) return fail(watched.error());
  if (watched->empty())
    return fail(Errc::negative, "none of the PDOs is in use",
                "`pdo show` lists them; `pdo enable` enables one");
  auto& session = *context.session;
  const auto begin = session.now();
  show::SampleWriter writer(context);
  const auto live = context.open_view(show::pdo_layout());
  writer.show_in(live.get());
  traffic::Listener listener;
  listener.is_over = [&] { return live && live->is_over(); };
  listener.on_pause = [&] {
    writer.flush();
    if (live) live->refresh(session.now());
  };
  listener.on_frame = [&](const can::Frame& frame, TimePoint time) {
    if (frame.remote || frame.error) return;
    for (auto& entry : *watched) {
      if (entry.view.can_id() != canopen::can_id_of(frame)) continue;
      entry.rhythm.add(time);
      show(context, writer, entry, frame, time - begin);
    }
  };
  if (const auto ended = traffic::listen(session, *length, listener); !ended) return fail(ended.error());
  tell_silence(context, *watched);
  if (!context.keeps_samples) return Value(summary(*watched));
  return Value(report::Record{{"pdos", summary(*watched)}, {"samples", writer.take_kept()}});
}

}  // namespace

extern const Command kPdoWatch;
const Command kPdoWatch{
    .path = "pdo watch",
    .summary = "Show PDOs as they arrive, decoded by the drive's mapping",
    .details =
        "Reads the mapping of the nodes and then listens: one line per PDO, with the names, values and units "
        "of its objects; on a terminal a table of the objects that is updated in place (keys: space pauses, s sorts, "
        "q quits). At the end (--for, or Ctrl-C) it shows how often each came, and the measured "
        "periods: mean, shortest, longest, standard deviation. RPDOs are shown if a master sends them.",
    .parameters = kParameters,
    .needs = Needs::node | Needs::can,
    .effect = Effect::reads,
    .run = run,
    .goes_on = true,
    .elsewhere =
        "`watch` and `scope` show values over time; in SAFE-OP and OP those of mapped inputs come by process data",
};

}  // namespace servoctl::commands
