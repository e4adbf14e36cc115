#include <optional>
#include <string>
#include <utility>

#include "base/format.hpp"
#include "can/byte_window.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "command/frame_filter.hpp"
#include "command/recording_columns.hpp"
#include "traffic/frames_around.hpp"
#include "traffic/recording.hpp"
#include "traffic/recording_summary.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

/// Before and after an occasion.
constexpr Duration kReach = std::chrono::milliseconds(500);

constexpr Parameter kDecodeParameters[] = {
    {.name = "file",
     .help =
         "a recording: --trace, candump, .asc, .trc, .blf, pcap, log or table of another tool; - is standard input",
     .kind = Kind::file,
     .required = true},
    kColumnsOption,
    {.name = "--clock", .help = "show the date and time of day that the recording has", .kind = Kind::flag},
    {.name = "--summary",
     .help =
         "nodes, states, periods, emergencies, SDO aborts, unanswered requests and gaps, in place of the frames",
     .kind = Kind::flag},
    {.name = "--around",
     .help = "only what was around these frames: emcy abort boot-up error",
     .kind = Kind::choice,
     .choices = traffic::kOccasions},
    {.name = "--within",
     .help = "with --around: how long before and after (default 500ms)",
     .kind = Kind::duration},
    {.name = "--raw", .help = "show the frames as well", .kind = Kind::flag},
    kServiceOption,
    kObjectOption,
};

/// What is to be told of a recording that was read, beside its frames.
Result<void> tell_of(Context& context, std::string_view file, const can::RecordingStrays& strays, bool any) {
  if (const auto base = traffic::check_base(file, strays); !base) return fail(base.error());
  const auto whole = traffic::check_damage(file, strays);
  if (!any) return whole ? traffic::no_frames(file, strays) : fail(whole.error());
  for (auto& notice : traffic::notices(file, strays)) context.notices.push_back(std::move(notice));
  if (!whole) context.errors.push_back(whole.error());
  return {};
}

/// The families of the axes of a cabinet file that the line names, where it names no family itself.
Result<void> take_cabinet(Context& context, const Arguments& arguments) {
  if (!arguments.has("--cabinet") || context.profile != nullptr || !context.families.empty()) return {};
  const auto cabinet = context.front_end->cabinet();
  if (!cabinet) return fail(cabinet.error());
  for (const auto& axis : (*cabinet)->axes) {
    const auto profile = context.front_end->family(axis.family);
    if (!profile) return fail(profile.error());
    const auto [known, added] = context.families.emplace(axis.node, *profile);
    if (!added && known->second != *profile)
      return fail(
          Errc::usage,
          message("the cabinet file has node {} on several buses, as {} and as {}", axis.node,
                  as_it_is(known->second->family), as_it_is(axis.family)),
          message("name the families of the recorded bus: -d {}={}", axis.node, as_it_is(axis.family)));
  }
  return {};
}

/// Where the frames of a recording go.
class Decoding {
 public:
  Decoding(Context& context, const Arguments& arguments, traffic::FrameFilter filter, Duration reach)
      : context_(&context),
        log_(context, std::move(filter), arguments.has("--raw")),
        wants_clock_(arguments.has("--clock")) {
    for (const auto& [node, profile] : context.families) log_.decoder().set_family(node, profile);
    if (wants_clock_) log_.show_clock(clock_);
    if (arguments.has("--summary")) summary_.emplace(context, context.families);
    if (arguments.has("--around"))
      around_.emplace(
          arguments.text("--around"), reach, [this](const can::LogFrame& line) { show(line); },
          [this](const can::LogFrame& line) { log_.skip(line.frame); });
  }
  Decoding(const Decoding&) = delete;
  Decoding& operator=(const Decoding&) = delete;

  can::LogClock& clock() { return clock_; }
  void flush() { log_.flush(); }

  /// False: no more is wanted.
  bool add(const can::LogFrame& line) {
    timeless_ = wants_clock_ && clock_.kind == can::LogClock::Kind::none;
    if (timeless_) return false;
    if (count_++ == 0 && clock_.kind != can::LogClock::Kind::none)
      begin_ = can::clock_text(clock_, line.time, ' ');
    if (summary_)
      summary_->add(line.time, line.frame);
    else if (around_)
      around_->add(line);
    else
      show(line);
    return !context_->audience_is_gone();
  }

  /// After the last frame. Errc::usage where the recording has no clock, and one was asked for.
  Result<void> end(std::string_view file) {
    if (summary_) summary_->end();
    if (around_) around_->end();
    log_.flush();
    if (timeless_)
      return fail(Errc::usage, message("{} has no date and no time of day", as_it_is(file)),
                  "leave --clock out: the times then count from the first frame");
    if (around_ && around_->occasions() == 0 && count_ > 0)
      context_->notices.push_back(message("{}: nothing of what --around names is in it", as_it_is(file)));
    return {};
  }

  std::size_t count() const { return count_; }
  Value answer() {
    if (summary_) return Value(summary_->record(begin_));
    return context_->keeps_samples ? Value(log_.take_kept()) : Value();
  }

 private:
  void show(const can::LogFrame& line) { log_.add(line.time, line.interface_name, line.frame); }

  Context* context_;
  can::LogClock clock_;
  traffic::FrameLog log_;
  std::optional<traffic::RecordingSummary> summary_;
  std::optional<traffic::FramesAround> around_;
  bool wants_clock_;
  bool timeless_ = false;
  std::size_t count_ = 0;
  std::string begin_;  ///< Of the first frame, by the clock.
};

/// What has no meaning together is a slip.
Result<void> check_options(const Arguments& arguments) {
  for (const auto* other : {"--around", "--service", "--object", "--raw", "--clock"})
    if (arguments.has("--summary") && arguments.has(other))
      return fail(Errc::usage, message("--summary and {} exclude each other", other),
                  "the summary is of the whole recording; -n limits it to nodes");
  if (arguments.has("--within") && !arguments.has("--around"))
    return fail(Errc::usage, "--within needs --around", "name what to look for: `--around emcy`");
  return {};
}

Result<Value> run_decode(Context& context, const Arguments& arguments) {
  if (const auto right = check_options(arguments); !right) return fail(right.error());
  auto filter = frame_filter(context, arguments);
  if (!filter) return fail(filter.error());
  const auto columns = recording_columns(arguments);
  if (!columns) return fail(columns.error());
  const auto reach = duration_option(arguments, "--within");
  if (!reach) return fail(reach.error());
  if (const auto taken = take_cabinet(context, arguments); !taken) return fail(taken.error());
  const auto file = arguments.text("file");
  auto source = can::open_recording(file);
  if (!source) return fail(source.error());
  Decoding decoding(context, arguments, std::move(*filter), reach->value_or(kReach));
  can::ByteWindow bytes(std::move(*source), [&decoding] { decoding.flush(); });
  const can::ReadOptions options{.columns = *columns ? &**columns : nullptr, .clock = &decoding.clock()};
  const auto strays = can::for_each_frame(
      bytes, [&](const can::LogFrame& line) { return decoding.add(line); }, options);
  if (const auto ended = decoding.end(file); !ended) return fail(ended.error());
  if (bytes.error() != 0)
    return fail(Errc::file, message("cannot read {}: {}", as_it_is(file), can::system_text(bytes.error())));
  if (const auto told = tell_of(context, file, strays, decoding.count() > 0); !told)
    return fail(told.error());
  return decoding.answer();
}

constexpr Example kDecodeExamples[] = {
    {"decode session.log -d gsd600", "a recording in words"},
    {"decode session.log --summary -d 3=gsd600,4=da200", "a mixed cabinet as a whole"},
    {"decode session.log --around emcy", "what happened before and after each emergency"},
};

}  // namespace

extern const Command kDecode;
const Command kDecode{
    .path = "decode",
    .summary = "Decode a recording: PDO and SDO with names and values, NMT, EMCY",
    .details =
        "Reads what --trace or candump wrote (-L, -l, or as on a terminal, -ta -td -tz -tA -x -a -e), .asc "
        "logs, PEAK .trc traces, Vector .blf logs, pcap and pcapng files with CAN frames, logs of CANreal, "
        "CanKing, BUSMASTER, CANoe and `python-can`, lines of `cansend`, and tables whose header names the "
        "columns (IXXAT, `Vehicle Spy`, SavvyCAN, USBCAN, any CSV), also quoted in a mail; what it is, the "
        "file tells. --columns names the columns of any other table, in their order or by their headings: "
        "`time`, `date`, `id`, `len`, `data`, `byte`, `type`, `channel`, `ext`, `rtr`, `error`, - for one "
        "that does not matter; `:ms`, `:us`, `:hex` and `:dec` say how one is written. Numbers that could be "
        "decimal or hexadecimal are not guessed. One that is cut short or damaged is shown up to there, and "
        "the place told; exit code 7. With -d the objects have their names, units and labels; a mixed "
        "cabinet takes a family for each node, -d 3=gsd600,4-6=da200, or those of --cabinet FILE; -n limits "
        "the output to these nodes (and frames without a node), --service and --object to such frames. "
        "--clock shows date and time of day, with Z if they are UTC, else as the recording computer had "
        "them. PDOs are decoded by the mapping read or written in the recording itself, else by the family's "
        "factory mapping. `-o jsonl` gives one document per frame. `-` reads a pipe, and shows each frame "
        "when it comes. --summary shows the recording as a whole, --around the frames before and after each "
        "EMCY, SDO abort, boot-up or error frame. A recording can also serve as a bus that answers commands: "
        "--bus replay:FILE.",
    .parameters = kDecodeParameters,
    .examples = kDecodeExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .family_by_node = true,
    .run = run_decode,
};

}  // namespace servoctl::commands
