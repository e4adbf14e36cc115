#include <algorithm>
#include <functional>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/sdo_abort.hpp"
#include "command/command.hpp"
#include "command/recording_columns.hpp"
#include "motion/left_energised.hpp"
#include "show/records.hpp"
#include "traffic/frame_decoder.hpp"
#include "traffic/replay_plan.hpp"
#include "traffic/replay_run.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Parameter kReplayParameters[] = {
    {.name = "file", .help = "a recording, as `decode` reads it", .kind = Kind::file, .required = true},
    {.name = "--speed", .help = "2 is twice as fast as recorded (default 1)", .kind = Kind::number},
    {.name = "--only",
     .help = "only this service, such as sdo (may be given several times)",
     .kind = Kind::choice,
     .choices = traffic::kServices,
     .repeats = true},
    {.name = "--master",
     .help = "only what a master sends: NMT, SYNC, TIME, SDO requests, RPDOs",
     .kind = Kind::flag},
    {.name = "--channel",
     .help = "which bus of a recording of several, as `decode` names it: can1",
     .kind = Kind::text},
    kColumnsOption,
};

/// How frames of a service are counted.
struct Counted {
  std::string_view service;
  std::string_view one;
  std::string_view several;
};
constexpr Counted kCounted[] = {
    {"nmt", "1 NMT command", "{} NMT commands"},
    {"sync", "1 SYNC message", "{} SYNC messages"},
    {"time", "1 TIME message", "{} TIME messages"},
    {"emcy", "1 emergency message", "{} emergency messages"},
    {"pdo", "1 PDO message", "{} PDO messages"},
    {"sdo", "1 SDO message", "{} SDO messages"},
    {"boot-up", "1 boot-up message", "{} boot-up messages"},
    {"heartbeat", "1 heartbeat", "{} heartbeats"},
    {"guarding", "1 guarding frame", "{} guarding frames"},
    {"lss", "1 LSS message", "{} LSS messages"},
};
constexpr Counted kOthers{"other", "1 other frame", "{} other frames"};

std::string counted(std::string_view service, std::size_t count) {
  const auto* found = std::ranges::find(kCounted, service, &Counted::service);
  const auto& words = found != std::end(kCounted) ? *found : kOthers;
  return count == 1 ? std::string(words.one) : formatted(fmt::runtime(words.several), count);
}

std::string question_replay(const traffic::ReplayPlan& plan, std::string_view file, std::string_view bus) {
  std::string services;
  for (const auto& [service, count] : plan.services) append(services, counted(service, count));
  auto out = formatted("Send the {} frames of {} on {} again: {}?", plan.frames.size(), file, bus, services);
  if (!plan.moving.empty())
    out += formatted(" {} of them can move a motor: {}.", plan.dangerous(), traffic::kinds_text(plan.moving));
  if (!plan.lasting.empty())
    out += formatted(" Some store, restart or re-address a drive: {}.", traffic::kinds_text(plan.lasting));
  return out;
}

Result<double> replay_speed(const Arguments& arguments) {
  if (!arguments.has("--speed")) return 1.0;
  const auto speed = parse_real(arguments.text("--speed"));
  if (!speed || *speed < 0.001 || *speed > 1000)
    return fail(Errc::usage, message("'{}' is not a speed", as_it_is(arguments.text("--speed"))),
                "write 0.001..1000; 1 is as recorded");
  return *speed;
}

/// A table without rows is worth no heading.
report::Show shown(bool any) { return any ? report::Show::everywhere : report::Show::json; }

report::Table kinds_table(const traffic::FrameKinds& kinds) {
  report::Table out;
  out.columns = {{"what"}, {"frames"}};
  for (const auto& [kind, count] : kinds) out.rows.push_back({kind, count});
  return out;
}

report::Table services_table(const traffic::ReplayPlan& plan) {
  report::Table out;
  out.columns = {{"service"}, {"frames"}};
  for (const auto& [service, count] : plan.services) out.rows.push_back({service, count});
  return out;
}

std::string failure_text(const Context& context, const traffic::ReplayFailure& failure) {
  const auto object = drive::target_at(context.profile, failure.object).in_sentence();
  if (!failure.abort_code)
    return formatted(fmt::runtime(failure.write ? "write of {} of node {} not answered"
                                                : "read of {} of node {} not answered"),
                     object, failure.node);
  return formatted(fmt::runtime(failure.write ? "write of {} of node {} refused: {} (abort 0x{:08X})"
                                              : "read of {} of node {} refused: {} (abort 0x{:08X})"),
                   object, failure.node, show::abort_words(context, *failure.abort_code),
                   *failure.abort_code);
}

/// What became of the SDO requests; exit code 1 where one was in vain.
void tell_failures(Context& context, const traffic::ReplayRun& run) {
  if (run.answered_by_recording() > 0)
    context.notices.push_back(message(
        "SDO requests answered only by the recording, not by a drive: {}; --master leaves such answers out",
        run.answered_by_recording()));
  const auto& failures = run.failures();
  if (failures.empty()) return;
  auto message = failure_text(context, failures.front());
  if (failures.size() > 1)
    message =
        formatted("{} SDO requests were refused or not answered; the first: {}", failures.size(), message);
  context.errors.push_back(
      show::located(make_error(Errc::negative, std::move(message),
                               "the drives are not in the recording's final state; see the table"),
                    failures.front().node, failures.front().object));
}

report::Table failures_table(const Context& context, const std::vector<traffic::ReplayFailure>& failures) {
  report::Table out;
  out.columns = {{"node"},
                 {"object", "", report::Show::text},
                 {"index", "", report::Show::json},
                 {"sub", "", report::Show::json},
                 {"name"},
                 {"request"},
                 {"abort"},
                 {"answer"}};
  for (const auto& failure : failures) {
    const auto& abort = failure.abort_code;
    const auto target = drive::target_at(context.profile, failure.object);
    out.rows.push_back({failure.node, to_string(failure.object), failure.object.index, failure.object.sub,
                        report::text_or_null(context.chinese ? target.label_zh() : target.label()),
                        failure.write ? "write" : "read",
                        abort ? Value(formatted("0x{:08X}", *abort)) : Value(),
                        abort ? show::abort_words(context, *abort) : "none"});
  }
  return out;
}

/// Drives that are moved and are not there cannot be stopped, and do not move either.
void remember_energised(Context& context, const traffic::ReplayPlan& plan,
                        const traffic::ReplayDrives& drives) {
  for (const auto node : plan.nodes) {
    if (drives.present.count(node) > 0)
      context.session->energised().insert(node);
    else
      context.notices.push_back(
          message("node {} does not answer: whether the replay energises it is not known", node_name(node)));
  }
}

Result<void> send_recorded(Context& context, const traffic::ReplayPlan& plan,
                           const traffic::ReplayDrives& drives, double speed, report::Record& answer) {
  auto& session = *context.session;
  const auto hold = session.protect(plan.moving.empty() ? session::Care::none : session::Care::guarded);
  remember_energised(context, plan, drives);
  traffic::ReplayRun replay(session);
  const auto done = replay.run(plan.frames, speed);
  if (!done) {
    // Over a lost bus nothing can be stopped: the front end says so, and tries when it is back.
    if (done.error().code != Errc::bus) motion::stop_left_energised(context);
    auto error = done.error();
    error.message =
        message("{}; {} of {} frames were sent", error.message, replay.sent(), plan.frames.size());
    return fail(std::move(error));
  }
  answer.push_back({"sent", replay.sent()});
  tell_failures(context, replay);
  answer.push_back(
      {"failures", failures_table(context, replay.failures()), shown(!replay.failures().empty())});
  return {};
}

/// A recording is sent to the drives it was made with: where a family is named, they are of it.
Result<void> hold_drives(Context& context, const traffic::ReplayDrives& drives) {
  const std::vector<std::uint8_t> nodes(drives.present.begin(), drives.present.end());
  return context.hold_family(nodes, context.profile, true);
}

void tell_plan(Context& context, const traffic::ReplayPlan& plan, std::string_view file) {
  for (auto& notice : traffic::notices(file, plan.strays)) context.notices.push_back(std::move(notice));
  if (plan.extended > 0)
    context.notices.push_back(
        plan.extended == 1 ? "1 frame with a 29-bit identifier is left out: these are not replayed"
                           : message("{} frames with 29-bit identifiers are left out: these are not replayed",
                                     plan.extended));
  std::string dropped;
  for (const auto id : plan.dropped) append(dropped, formatted("0x{:03X}", id));
  if (!dropped.empty())
    context.notices.push_back(
        message("left out, taken as TPDOs by CAN-ID only (not confirmed by a drive or family): {}", dropped));
}

std::string_view channel_of(const Arguments& arguments) {
  return arguments.has("--channel") ? arguments.text("--channel") : std::string_view();
}

/// What is recorded in the file, of one bus.
Result<std::string> recording_of(const Arguments& arguments, const can::ReadOptions& read) {
  const auto file = arguments.text("file");
  auto text = traffic::read_recording(file);
  if (!text) return text;
  const auto first = can::for_each_frame(
      *text, [](const can::LogFrame&) { return false; }, read);
  if (const auto base = traffic::check_base_is_certain(file, first); !base) return fail(base.error());
  // A heading is no proof of what a column holds, and what is misread could move a motor.
  if (first.of_table && read.columns == nullptr)
    return fail(
        Errc::refused,
        message("{}: frames of a table or log of another tool are sent only where its columns are named",
                as_it_is(file)),
        "say what its columns are, `--columns time:s,id:hex,len,data:hex`; `decode` shows its frames");
  if (const auto one = traffic::check_channel(file, *text, channel_of(arguments), read); !one)
    return fail(one.error());
  return text;
}

/// Whether there is something to send, and it can be sent as it was recorded.
Result<void> check_plan(const traffic::ReplayPlan& plan, std::string_view file) {
  if (auto whole = traffic::check_damage(file, plan.strays); !whole) {
    whole.error().hint = "no frame of it was sent; `decode` shows what stands in front of that byte";
    return fail(whole.error());
  }
  if (plan.seen == 0) return traffic::no_frames(file, plan.strays);
  if (plan.frames.size() > 1 && plan.frames.back().time == Duration::zero())
    return fail(Errc::usage, message("{} has no timestamps: its frames cannot be timed", as_it_is(file)),
                "`candump -L` and `candump -ta` write them, `monitor --trace FILE` too");
  if (plan.frames.empty())
    return fail(Errc::negative, message("no frame of the {} in {} is sent", plan.seen, as_it_is(file)),
                "--only and --master leave them out");
  return {};
}

Result<Value> run_replay(Context& context, const Arguments& arguments) {
  const auto file = arguments.text("file");
  const auto speed = replay_speed(arguments);
  if (!speed) return fail(speed.error());
  const auto columns = recording_columns(arguments);
  if (!columns) return fail(columns.error());
  const can::ReadOptions read{.columns = *columns ? &**columns : nullptr};
  const auto text = recording_of(arguments, read);
  if (!text) return fail(text.error());
  const traffic::ReplayChoice choice{.only = arguments.all("--only"),
                                     .of_master = arguments.has("--master"),
                                     .channel = channel_of(arguments),
                                     .read = read};
  const auto drives = traffic::find_drives(context, *text, choice.channel, read);
  if (!drives) return fail(drives.error());
  const auto plan = traffic::plan_replay(context, choice, *text, *drives);
  tell_plan(context, plan, file);
  if (const auto good = check_plan(plan, file); !good) return fail(good.error());
  report::Record answer{{"frames", plan.frames.size()},
                        {"can_move", plan.dangerous(), report::Show::everywhere, "can move a motor"}};
  if (!context.dry_run) {
    if (const auto right = hold_drives(context, *drives); !right) return fail(right.error());
    if (const auto sure = context.confirm(question_replay(plan, file, context.session->url())); !sure)
      return fail(sure.error());
    if (const auto done = send_recorded(context, plan, *drives, *speed, answer); !done)
      return fail(done.error());
  } else {
    for (const auto* key : {"sent", "failures"}) answer.push_back({key, Value(), report::Show::json});
  }
  answer.push_back({"services", services_table(plan)});
  answer.push_back({"moving", kinds_table(plan.moving), shown(!plan.moving.empty()), "can move a motor"});
  answer.push_back({"lasting", kinds_table(plan.lasting), shown(!plan.lasting.empty()), "last or restart"});
  return Value(std::move(answer));
}

constexpr Example kReplayExamples[] = {
    {"replay session.log --dry-run", "first: count the frames that can move a motor"},
    {"replay session.log --master --only sdo", "the SDO requests of the master, after a question"},
};

}  // namespace

extern const Command kReplay;
const Command kReplay{
    .path = "replay",
    .summary = "Send the frames of a recording again; asks first",
    .details =
        "Keeps the times between the frames, unless --speed says otherwise. It sends the frames of drives "
        "and masters alike: if the real drives are connected, --master leaves theirs out; --only selects "
        "services, --channel one bus of a recording of several, which is refused without it. It first reads the "
        "PDOs of the drives in the recording, then asks you, stating how many of the frames can move a motor (NMT "
        "start, SYNC, RPDOs and PDOs of unknown direction, writes to objects from 2000h up except those that a "
        "family's data says need a restart) and which store, restart or re-address a drive; --dry-run only reads "
        "and counts. After Ctrl-C or an error the drives are stopped and disabled, over a connection that was "
        "lost once it is back; any that a complete replay leaves energised is listed. Exit code 1 if a "
        "drive refused an SDO request or did not answer it. To have commands answered by a recording "
        "instead, use --bus replay:FILE.",
    .parameters = kReplayParameters,
    .examples = kReplayExamples,
    .needs = Needs::can,
    .effect = Effect::moves,
    .run = run_replay,
};

}  // namespace servoctl::commands
