#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <set>

#include "base/number.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/nmt.hpp"
#include "commands/command.hpp"
#include "commands/frame_decoder.hpp"
#include "commands/recording.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::commands {
namespace {

using report::Value;

constexpr Parameter kParameters[] = {
    {.name = "file",
     .help = "a recording in the form of candump, or .asc",
     .kind = Kind::file,
     .required = true},
    {.name = "--speed", .help = "2 is twice as fast as recorded (default 1)", .kind = Kind::number},
    {.name = "--only",
     .help = "only this service, such as sdo (may be given several times)",
     .kind = Kind::choice,
     .choices = kServices,
     .repeats = true},
    {.name = "--master",
     .help = "only what a master sends: NMT, SYNC, TIME, SDO requests, RPDOs",
     .kind = Kind::flag},
};

/// What is to be sent, and what may come of it.
struct Plan {
  std::vector<can::LogFrame> frames;
  std::map<std::string_view, std::size_t> services;
  std::size_t dangerous = 0;     ///< NMT start, RPDOs, writes of the controlword.
  std::set<std::uint8_t> nodes;  ///< That these are sent to.
};

/// Whether a drive takes the frame for a command that can move its motor.
bool may_move(const can::Frame& frame, const DecodedFrame& decoded, const PdoView* pdo) {
  if (decoded.service == "nmt")
    return !frame.remote && frame.data[0] == static_cast<std::uint8_t>(canopen::NmtCommand::start);
  if (decoded.service == "pdo" && !frame.remote)
    return pdo != nullptr ? pdo->pdo.direction == canopen::PdoDirection::receive : (frame.id & 0x80U) == 0;
  const bool request =
      frame.id > canopen::kSdoRequest && frame.id <= canopen::kSdoRequest + canopen::kLastNode;
  return decoded.service == "sdo" && request &&
         std::any_of(decoded.objects.begin(), decoded.objects.end(),
                     [](ObjectAddress object) { return object == objects::kControlword; });
}

/// Whether only a master sends it (CiA 301, 7.3.5).
bool is_of_master(const can::Frame& frame, const DecodedFrame& decoded, const PdoView* pdo) {
  if (decoded.service == "nmt" || decoded.service == "sync" || decoded.service == "time" ||
      decoded.service == "guarding")
    return true;
  if (decoded.service == "sdo") return frame.id > canopen::kSdoRequest;
  return decoded.service == "pdo" && may_move(frame, decoded, pdo);
}

/// Chooses the frames; reports of the controller and 29-bit identifiers are none that CANopen sends.
Strays choose(Context& context, const Arguments& arguments, std::string_view text, Plan& plan) {
  FrameDecoder decoder({context.profile, false, false});
  const auto only = arguments.all("--only");
  const bool master = arguments.has("--master");
  return for_each_frame(text, [&](const can::LogFrame& line) {
    const auto& frame = line.frame;
    if (frame.error || frame.extended) return true;
    const auto& decoded = decoder.decode(frame);
    const auto* pdo = decoded.service == "pdo" ? decoder.pdos().find(frame.id) : nullptr;
    if (!only.empty() && std::find(only.begin(), only.end(), decoded.service) == only.end()) return true;
    if (master && !is_of_master(frame, decoded, pdo)) return true;
    ++plan.services[decoded.service];
    const bool moves = may_move(frame, decoded, pdo);
    plan.dangerous += moves;
    if (moves && decoded.node) plan.nodes.insert(*decoded.node);
    plan.frames.push_back(line);
    return true;
  });
}

std::string question(const Plan& plan, std::string_view file, std::string_view bus) {
  std::string kinds;
  for (const auto& [service, count] : plan.services)
    kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", count, service);
  auto out = fmt::format("Send the {} frames of {} on {} again ({})?", plan.frames.size(), file, bus, kinds);
  if (plan.dangerous > 0)
    out += fmt::format(" {} of them can move a motor: NMT start, RPDO or controlword.", plan.dangerous);
  return out;
}

Result<double> speed_of(const Arguments& arguments) {
  if (!arguments.has("--speed")) return 1.0;
  const auto speed = parse_real(arguments.text("--speed"));
  if (!speed || *speed < 0.001 || *speed > 1000)
    return fail(Errc::usage, fmt::format("'{}' is no speed", arguments.text("--speed")),
                "write 0.001..1000; 1 is as recorded");
  return *speed;
}

/// Sends the frames with the time between them that the recording has, divided by `speed`; a time that goes
/// back counts as none. The answer is how many were sent.
Result<std::size_t> send_all(session::Session& session, std::span<const can::LogFrame> frames, double speed) {
  std::size_t sent = 0;
  auto due = session.now();
  while (sent < frames.size()) {
    const auto waited = session.wait([] { return false; }, due);
    if (!waited && waited.error().code == Errc::interrupted) return sent;
    if (!waited) return tl::unexpected<Error>(waited.error());
    if (const auto done = session.send(frames[sent].frame); !done) return tl::unexpected<Error>(done.error());
    ++sent;
    if (sent == frames.size()) break;
    const auto gap = std::max(frames[sent].time - frames[sent - 1].time, Duration::zero());
    due += std::chrono::duration_cast<Duration>(gap / speed);
  }
  return sent;
}

Result<Value> run(Context& context, const Arguments& arguments) {
  const auto file = arguments.text("file");
  const auto speed = speed_of(arguments);
  if (!speed) return tl::unexpected<Error>(speed.error());
  const auto text = read_recording(file);
  if (!text) return tl::unexpected<Error>(text.error());
  Plan plan;
  const auto strays = choose(context, arguments, *text, plan);
  for (auto& notice : notices(file, strays)) context.notices.push_back(std::move(notice));
  if (plan.frames.empty()) return no_frames(file);
  report::Table services;
  services.columns = {{"service"}, {"frames"}};
  for (const auto& [service, count] : plan.services) services.rows.push_back({service, count});
  report::Record answer{{"frames", plan.frames.size()},
                        {"can_move", plan.dangerous, report::Show::everywhere, "can move a motor"}};
  if (!context.dry_run) {
    if (const auto sure = context.confirm(question(plan, file, context.session->url())); !sure)
      return tl::unexpected<Error>(sure.error());
    context.session->energised().insert(plan.nodes.begin(), plan.nodes.end());
    const auto sent = send_all(*context.session, plan.frames, *speed);
    if (!sent) return tl::unexpected<Error>(sent.error());
    answer.push_back({"sent", *sent});
    if (*sent < plan.frames.size())
      context.notices.push_back(
          fmt::format("interrupted: {} frames were not sent", plan.frames.size() - *sent));
  }
  answer.push_back({"services", std::move(services)});
  return Value(std::move(answer));
}

}  // namespace

extern const Command kReplay;
const Command kReplay{
    .path = "replay",
    .summary = "Send the frames of a recording again; asks first",
    .details =
        "Keeps the times between the frames, unless --speed says otherwise. It sends what drives and masters "
        "sent "
        "alike: "
        "where the drives are there themselves, --master leaves their part out, and --only chooses services. "
        "It "
        "asks, "
        "and says how many of the frames can move a motor (NMT start, RPDOs, writes of the controlword); "
        "--dry-run "
        "only "
        "counts. To have commands answered by a recording instead, use --bus replay:FILE.",
    .parameters = kParameters,
    .needs = Needs::bus,
    .effect = Effect::moves,
    .run = run,
};

}  // namespace servoctl::commands
