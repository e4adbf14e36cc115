#include <fmt/format.h>
#include <algorithm>

#include "base/file.hpp"
#include "base/text.hpp"
#include "can/trace.hpp"
#include "commands/command.hpp"
#include "commands/frame_decoder.hpp"

namespace servoctl::commands {
namespace {

using report::Value;

constexpr std::uintmax_t kMaxFile = std::uintmax_t{1} << 30U;

constexpr Parameter kParameters[] = {
    {.name = "file", .help = "a recording in the form of candump -L", .kind = Kind::file, .required = true},
    {.name = "--raw", .help = "show the frames as well", .kind = Kind::flag},
};

bool is_wanted(const Context& context, std::optional<std::uint8_t> node) {
  const auto& nodes = context.nodes;
  if (nodes.empty() || nodes.front() == 0 || !node) return true;
  return std::find(nodes.begin(), nodes.end(), *node) != nodes.end();
}

/// Emits the frames of the recording one by one; the last one is not kept but for `--json`.
class Recording {
 public:
  Recording(Context& context, bool raw)
      : context_(&context), decoder_(context.profile, context.chinese), raw_(raw) {}

  void add(const can::LogFrame& line) {
    if (count_++ == 0) begin_ = line.time;
    auto decoded = decoder_.decode(line.frame);
    if (!is_wanted(*context_, decoded.node)) return;
    const std::chrono::duration<double> since = line.time - begin_;
    const std::chrono::duration<double> time = line.time;
    const auto frame = can::to_string(line.frame);
    report::Record record{{"time", time.count()},
                          {"interface", line.interface_name},
                          {"frame", frame},
                          {"service", decoded.service},
                          {"node", decoded.node ? Value(*decoded.node) : Value()}};
    for (auto& field : decoded.fields) record.push_back(std::move(field));
    record.push_back({"text", decoded.text});
    context_->emit(record, line_text(since.count(), frame, decoded));
    if (context_->keeps_samples) frames_.emplace_back(std::move(record));
  }

  std::size_t count() const { return count_; }
  report::List take_frames() { return std::move(frames_); }

 private:
  std::string line_text(double seconds, const std::string& frame, const DecodedFrame& decoded) const {
    const auto node = decoded.node ? fmt::format("{:3}", *decoded.node) : std::string("  -");
    const auto shown = raw_ ? pad_right(frame, 21) + " " : std::string();
    return fmt::format("{:11.6f} {}{} {}", seconds, shown, node, decoded.text);
  }

  Context* context_;
  FrameDecoder decoder_;
  bool raw_;
  std::size_t count_ = 0;
  Duration begin_{};
  report::List frames_;
};

Result<Value> run(Context& context, const Arguments& arguments) {
  const std::string path(arguments.text("file"));
  const auto text = read_file(path, kMaxFile);
  if (!text) return tl::unexpected<Error>(text.error());
  Recording recording(context, arguments.has("--raw"));
  std::size_t strays = 0;
  for (const auto row : split(std::string_view(*text), '\n')) {
    if (const auto line = can::parse_log_line(row))
      recording.add(*line);
    else
      strays += !trim(row).empty();
  }
  if (recording.count() == 0)
    return fail(Errc::file, fmt::format("{} holds no frame", path),
                "recordings are in the form of `candump -L`; `--trace FILE` makes them");
  if (strays > 0) context.notices.push_back(fmt::format("{}: {} lines are no frames", path, strays));
  if (!context.keeps_samples) return Value();
  return Value(recording.take_frames());
}

}  // namespace

extern const Command kDecode;
const Command kDecode{
    .path = "decode",
    .summary = "Explain a recording: SDO with names and values, NMT, EMCY",
    .details =
        "Reads what --trace or `candump -L` wrote. With -d the objects have their names, units and labels; "
        "with -n "
        "only these nodes (and frames of the whole bus) are shown. `-o jsonl` gives one document a frame. "
        "The same "
        "file answers commands again as a bus: --bus replay:FILE.",
    .parameters = kParameters,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run,
};

}  // namespace servoctl::commands
