#include <fmt/format.h>
#include <algorithm>

#include "base/file.hpp"
#include "base/text.hpp"
#include "can/asc.hpp"
#include "can/trace.hpp"
#include "command/command.hpp"
#include "command/frame_filter.hpp"
#include "traffic/recording.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Parameter kDecodeParameters[] = {
    {.name = "file",
     .help = "a recording: --trace, candump -L, -l, -ta or plain, .asc, .trc, .blf, pcap, pcapng",
     .kind = Kind::file,
     .required = true},
    {.name = "--raw", .help = "show the frames as well", .kind = Kind::flag},
    kServiceOption,
    kObjectOption,
};

Result<Value> run_decode(Context& context, const Arguments& arguments) {
  auto filter = frame_filter(context, arguments);
  if (!filter) return fail(filter.error());
  const auto text = traffic::read_recording(arguments.text("file"));
  if (!text) return fail(text.error());
  traffic::FrameLog log(context, std::move(*filter), arguments.has("--raw"));
  const auto strays = traffic::for_each_frame(*text, [&](const can::LogFrame& line) {
    log.add(line.time, line.interface_name, line.frame);
    return true;
  });
  log.flush();
  const auto whole = traffic::check_damage(arguments.text("file"), strays);
  if (log.count() == 0) return whole ? traffic::no_frames(arguments.text("file")) : fail(whole.error());
  for (auto& notice : traffic::notices(arguments.text("file"), strays))
    context.notices.push_back(std::move(notice));
  if (!whole) context.errors.push_back(whole.error());
  if (!context.keeps_samples) return Value();
  return Value(log.take_kept());
}

constexpr Example kDecodeExamples[] = {
    {"decode session.log -d gsd600", "a recording in words"},
    {"decode session.log -n 1 --service emcy -d gsd600", "emergencies of node 1"},
    {"decode trace.trc --object 0x6040 -o jsonl", "the frames with the controlword, for a script"},
};

}  // namespace

extern const Command kDecode;
const Command kDecode{
    .path = "decode",
    .summary = "Decode a recording: PDO and SDO with names and values, NMT, EMCY",
    .details =
        "Reads what --trace or candump wrote (-L, -l, or as on a terminal, -ta -tz -tA -x -a), .asc logs, PEAK "
        ".trc traces, Vector .blf logs, and pcap and pcapng files with CAN frames; what it is, the file tells. One "
        "that is cut short or damaged is shown up to there, and the place told; exit code 7. With -d the objects have their names, units and labels; -n limits the output to these nodes "
        "(and frames without a node), --service and --object to such frames. PDOs are decoded by the mapping "
        "read or written in the recording itself, else by the family's factory mapping. `-o jsonl` gives one "
        "document per frame. A recording can also serve as a bus that answers commands: --bus "
        "replay:FILE.",
    .parameters = kDecodeParameters,
    .examples = kDecodeExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_decode,
};

}  // namespace servoctl::commands
