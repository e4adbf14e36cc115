#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "base/format.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "pdo/pdo_use.hpp"
#include "session/ethercat_network.hpp"
#include "session/hearing.hpp"
#include "session/process_values.hpp"
#include "show/live_pdo.hpp"
#include "show/sample_writer.hpp"
#include "traffic/image_pdos.hpp"
#include "traffic/listening.hpp"
#include "traffic/rhythm_table.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Parameter kPdoWatchParameters[] = {
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
  TimePoint last = {};              ///< On a ring: when the cycle was sent that was taken last.
  std::optional<Bytes> shown = {};  ///< On a ring: what the last line showed.
};

/// The PDOs of one node that were asked for and are in use.
Result<void> add_pdos(Context& context, const Arguments& arguments, std::uint8_t node,
                      std::vector<Watched>& out) {
  const bool ring = context.session->ethercat() != nullptr;
  const auto views = ring ? traffic::ImagePdos::read(context, node) : pdo::read_views(context, node);
  if (!views) return fail(views.error());
  for (const auto& name : arguments.all("pdo")) {
    const auto view = pdo::find_view(*views, node, name);
    if (!view) return fail(view.error());
    if (!ring && !(*view)->pdo.is_valid())
      return fail(Errc::negative, message("node {}: {} is not in use", node_name(node), (*view)->name),
                  "bit 31 of its COB-ID is set; `pdo enable` clears it");
    out.push_back({**view});
  }
  if (arguments.has("pdo")) return {};
  for (const auto& view : *views)
    if (ring || view.pdo.is_valid()) out.push_back({view});
  return {};
}

Result<std::vector<Watched>> watched_pdos(Context& context, const Arguments& arguments) {
  std::vector<Watched> out;
  for (const auto node : context.nodes)
    if (const auto added = add_pdos(context, arguments, node, out); !added) return fail(added.error());
  return out;
}

/// The PDOs of the nodes on CAN, for as long as the command runs. Once those of a node no longer hold as they
/// were read, its frames are shown without values until they were read again.
class Mappings {
 public:
  /// `all`: those that are in use are watched, not those that were named. To be made before they are read.
  Mappings(Context& context, bool all) : context_(&context), all_(all) {
    if (context.session->can() == nullptr) return;
    for (const auto node : context.nodes) mappings_.push_back({node, {*context.session, node}});
  }

  /// To be called before a frame is shown.
  void check(std::span<Watched> watched) {
    for (auto& mapping : mappings_) {
      const auto why = mapping.ended ? std::string() : mapping.lifetime.ended();
      if (why.empty()) continue;
      mapping.ended = true;
      for (auto& entry : watched)
        if (entry.view.node == mapping.node) entry.view.fields.clear();
      traffic::tell_now(
          *context_,
          formatted("node {} {}: its PDOs are shown without values until its PDO mapping has been read again",
                    mapping.node, why));
    }
  }

  /// To be called while nothing arrives.
  void renew(std::vector<Watched>& watched) {
    for (auto& mapping : mappings_) {
      if (!mapping.lifetime.is_to_renew()) continue;
      const session::Lifetime lifetime(*context_->session, mapping.node);
      auto views = pdo::read_views(*context_, mapping.node);
      if (!views) continue;
      mapping.lifetime = lifetime;
      mapping.ended = false;
      for (auto& view : *views) take(std::move(view), watched);
      traffic::tell_now(*context_, formatted("node {}: its PDO mapping was read again", mapping.node));
    }
  }

 private:
  struct Mapping {
    std::uint8_t node;
    session::Lifetime lifetime;
    bool ended = false;  ///< And that was told.
  };

  void take(show::PdoView view, std::vector<Watched>& watched) const {
    const auto known = std::find_if(watched.begin(), watched.end(), [&](const Watched& entry) {
      return entry.view.node == view.node && entry.view.name == view.name;
    });
    if (known != watched.end())
      known->view = std::move(view);
    else if (all_ && view.pdo.is_valid())
      watched.push_back({std::move(view)});
  }

  Context* context_;
  bool all_;
  std::vector<Mapping> mappings_;
};

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

void show(Context& context, show::SampleWriter& writer, const Watched& entry, ByteSpan data, Duration time) {
  const auto& view = entry.view;
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
  auto line = formatted("{:11.6f} {:3} {} ", seconds, view.node, view.name);
  show::append_values(view, data, context.chinese, line);
  writer.add_line(line);
}

/// What the cycles of a ring brought. Of those that all carry the same, the first is shown.
void take_cycles(Context& context, show::SampleWriter& writer, std::span<Watched> watched, TimePoint begin) {
  const traffic::ImagePdos image(*context.session);
  for (auto& entry : watched) {
    auto cycle = image.take(entry.view, entry.last);
    if (!cycle) continue;
    entry.last = cycle->time;
    entry.rhythm.add(cycle->time);
    if (entry.shown == cycle->data) continue;
    show(context, writer, entry, cycle->data, cycle->time - begin);
    entry.shown = std::move(cycle->data);
  }
}

std::uint64_t fd_frames(const Context& context) {
  auto* can = context.session->can();
  return can == nullptr ? 0 : can->bus().fd_frames();
}

/// Why nothing came, on CAN, and of CAN FD frames so many.
void tell_silence(Context& context, std::span<const Watched> watched, std::uint64_t fd_frames) {
  const bool silent = std::all_of(watched.begin(), watched.end(),
                                  [](const Watched& entry) { return entry.rhythm.count() == 0; });
  if (silent && fd_frames > 0)
    context.notices.push_back(message(
        "no PDO of classical CAN came; CAN FD frames that came and were not read: {}. Is a node set to CAN FD?",
        fd_frames));
  else if (silent)
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

/// Drives on a ring whose process data have ended meanwhile.
void tell_ended(Context& context, std::span<const Watched> watched) {
  std::set<std::uint8_t> nodes;
  for (const auto& entry : watched) nodes.insert(entry.view.node);
  for (const auto node : nodes)
    if (context.session->ethercat()->image_of(node) == nullptr)
      context.errors.push_back(
          drive_error(Errc::negative, node, "its process data have ended",
                      message("`status -n {}` shows its state and why", node_name(node))));
}

/// Shows what comes until it is ended; of each PDO it keeps how often it came.
Result<void> listen(Context& context, show::SampleWriter& writer, std::vector<Watched>& watched,
                    const std::optional<Duration>& length, Mappings& mappings) {
  auto& session = *context.session;
  const auto begin = session.now();
  const auto end = length ? begin + *length : kNever;
  const auto live = context.open_view(show::pdo_layout());
  writer.show_in(live.get());
  traffic::Listener listener;
  listener.is_over = [&] { return live && live->is_over(); };
  listener.on_bus = session::BusReturn::to_people(session);
  listener.on_pause = [&] {
    mappings.check(watched);
    mappings.renew(watched);
    writer.flush();
    if (live) live->refresh(session.now());
  };
  // Also while a mapping is read again.
  const session::Hearing hearing(session, [&](const can::Frame& frame, TimePoint time) {
    if (frame.remote || frame.error || time >= end) return;
    mappings.check(watched);
    for (auto& entry : watched) {
      if (!entry.view.pdo.is_valid() || entry.view.can_id() != canopen::can_id_of(frame)) continue;
      entry.rhythm.add(time);
      show(context, writer, entry, frame.payload(), time - begin);
    }
  });
  for (auto& entry : watched) entry.last = begin;
  if (session.ethercat() != nullptr) listener.on_step = [&] { take_cycles(context, writer, watched, begin); };
  auto ended = traffic::listen(session, length, listener);
  writer.show_in(nullptr);
  return ended;
}

Result<Value> run_pdo_watch(Context& context, const Arguments& arguments) {
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  if (context.session->gateway() != nullptr)
    return fail(Errc::usage,
                message("'pdo watch' needs CAN or EtherCAT, {} is neither", as_it_is(context.session->url())),
                "`watch` reads objects there, again and again");
  Mappings mappings(context, !arguments.has("pdo"));
  auto watched = watched_pdos(context, arguments);
  if (!watched) return fail(watched.error());
  if (watched->empty())
    return fail(Errc::negative, "none of the PDOs is in use",
                "`pdo show` lists them; `pdo enable` enables one");
  show::SampleWriter writer(context);
  const auto fd_before = fd_frames(context);
  const auto ended = listen(context, writer, *watched, *length, mappings);
  if (!traffic::has_summary(ended, context.errors)) return fail(ended.error());
  if (context.session->ethercat() != nullptr)
    tell_ended(context, *watched);
  else
    tell_silence(context, *watched, fd_frames(context) - fd_before);
  if (!context.keeps_samples) return Value(summary(*watched));
  return Value(report::Record{{"pdos", summary(*watched)},
                              {"fd_frames", fd_frames(context) - fd_before},
                              {"samples", writer.take_kept()}});
}

constexpr Example kPdoWatchExamples[] = {
    {"pdo watch -n 1 -d gsd600", "all that are in use, until Ctrl-C"},
    {"pdo watch TPDO1 --for 10s -n 1 -d gsd600", "one of them, with its period at the end"},
};

}  // namespace

extern const Command kPdoWatch;
const Command kPdoWatch{
    .path = "pdo watch",
    .summary = "Show PDOs as they arrive, decoded by the drive's mapping",
    .details =
        "Reads the mapping of the nodes and then listens: one line per PDO, with the names, values and units "
        "of its objects; on a terminal a table of the objects that is updated in place (keys: space pauses, s "
        "sorts, q quits). At the end (--for, or Ctrl-C) it shows how often each came, and the measured "
        "periods: mean, shortest, longest, standard deviation. RPDOs are shown if a master sends them. Over "
        "EtherCAT a drive has to be in OP (`state op` before, at the prompt or in a batch file): shown are the "
        "PDOs assigned, one line per change, and every cycle is counted.",
    .parameters = kPdoWatchParameters,
    .examples = kPdoWatchExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run_pdo_watch,
    .goes_on = true,
};

}  // namespace servoctl::commands
