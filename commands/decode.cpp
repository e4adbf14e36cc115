#include <algorithm>

#include "base/format.hpp"
#include "can/byte_window.hpp"
#include "command/command.hpp"
#include "command/frame_filter.hpp"
#include "command/recording_columns.hpp"
#include "traffic/recording.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Parameter kDecodeParameters[] = {
    {.name = "file",
     .help =
         "a recording: --trace, candump, .asc, .trc, .blf, pcap, log or table of another tool; - is standard input",
     .kind = Kind::file,
     .required = true},
    kColumnsOption,
    {.name = "--clock", .help = "show the date and time of day that the recording has", .kind = Kind::flag},
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

Result<Value> run_decode(Context& context, const Arguments& arguments) {
  auto filter = frame_filter(context, arguments);
  if (!filter) return fail(filter.error());
  const auto columns = recording_columns(arguments);
  if (!columns) return fail(columns.error());
  const auto file = arguments.text("file");
  auto source = can::open_recording(file);
  if (!source) return fail(source.error());
  traffic::FrameLog log(context, std::move(*filter), arguments.has("--raw"));
  can::LogClock clock;
  if (arguments.has("--clock")) log.show_clock(clock);
  can::ByteWindow bytes(std::move(*source), [&log] { log.flush(); });
  const can::ReadOptions options{.columns = *columns ? &**columns : nullptr, .clock = &clock};
  bool timeless = false;
  const auto take = [&](const can::LogFrame& line) {
    timeless = arguments.has("--clock") && clock.kind == can::LogClock::Kind::none;
    if (!timeless) log.add(line.time, line.interface_name, line.frame);
    return !timeless && !context.audience_is_gone();
  };
  const auto strays = can::for_each_frame(bytes, take, options);
  log.flush();
  if (timeless)
    return fail(Errc::usage, formatted("{} has no date and no time of day", file),
                "leave --clock out: the times then count from the first frame");
  if (bytes.error() != 0)
    return fail(Errc::file, formatted("cannot read {}: {}", file, can::system_text(bytes.error())));
  if (const auto told = tell_of(context, file, strays, log.count() > 0); !told) return fail(told.error());
  if (!context.keeps_samples) return Value();
  return Value(log.take_kept());
}

constexpr Example kDecodeExamples[] = {
    {"decode session.log -d gsd600", "a recording in words"},
    {"decode session.log -n 1 --service emcy -d gsd600", "emergencies of node 1"},
    {"decode table.csv --columns time:ms,-,id:hex,len,data", "a table whose header names no columns"},
    {"decode trace.trc --object 0x6040 -o jsonl", "the frames with the controlword, for a script"},
};

}  // namespace

extern const Command kDecode;
const Command kDecode{
    .path = "decode",
    .summary = "Decode a recording: PDO and SDO with names and values, NMT, EMCY",
    .details =
        "Reads what --trace or candump wrote (-L, -l, or as on a terminal, -ta -td -tz -tA -x -a -e), .asc logs, PEAK "
        ".trc traces, Vector .blf logs, pcap and pcapng files with CAN frames, logs of CANreal, CanKing, BUSMASTER, "
        "CANoe and python-can, lines of cansend, and tables whose header names the columns (IXXAT, Vehicle Spy, "
        "SavvyCAN, USBCAN, any CSV), also quoted in a mail; what it is, the file tells. --columns names the columns "
        "of any other table, in their order or by their headings: time date id len data byte type channel ext rtr "
        "error, - for one that does not matter; :ms, :us, :hex and :dec say how one is written. Numbers that could be "
        "decimal or hexadecimal are not guessed. One that is cut short or damaged is shown up to there, and the place "
        "told; exit code 7. With -d the objects have their names, units and labels; -n limits the output to these "
        "nodes (and frames without a node), --service and --object to such frames. --clock shows date and time of "
        "day, with Z if they are UTC, else as the recording computer had them. PDOs are decoded by the mapping read "
        "or written in the recording itself, else by the family's factory mapping. `-o jsonl` gives one document per "
        "frame. `-` reads a pipe, and shows each frame when it comes. A recording can also serve as a bus that "
        "answers commands: --bus replay:FILE.",
    .parameters = kDecodeParameters,
    .examples = kDecodeExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_decode,
};

}  // namespace servoctl::commands
