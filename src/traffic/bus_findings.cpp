// What was heard, and what it means.
#include <fmt/format.h>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/bitrate.hpp"
#include "traffic/link_findings.hpp"

namespace servoctl::traffic {
namespace {

using Level = Finding::Level;
using can::ControllerReport;
using can::LinkHealth;
using can::WireError;

constexpr double kHighLoad = 70;  ///< Per cent: low priorities begin to wait.
constexpr double kOverload = 90;
/// A sender that nobody acknowledges stops counting here (ISO 11898-1, 12.1.4.2).
constexpr std::uint16_t kPassive = 128;
constexpr std::uint16_t kWarning = 96;

double in_seconds(Duration time) { return std::chrono::duration<double>(time).count(); }

/// How the bitrate is found, and taken: an adapter behind slcan: takes it with its URL.
std::string find_bitrate(const LinkFacts* facts, std::string_view url) {
  if (facts == nullptr) return bitrate_search(url);
  return formatted("`bus detect {0}`, and `bus up {0} --bitrate …`", facts->name);
}

std::string ask_the_silent(const LinkFacts* facts) {
  if (facts == nullptr) return "`doctor --active` asks them";
  if (facts->state.listen_only)
    return formatted("`bus up {0}` ends the listen-only mode, then `doctor {0} --active` asks them",
                     facts->name);
  return formatted("`doctor {} --active` asks them", facts->name);
}

bool sends_in_vain(const BusPicture& picture, const LinkFacts* facts) {
  if (picture.frames() > 0) return false;
  if (picture.unacknowledged() > 0) return true;
  // Not bus-off, no damage, and as many errors of sending as it takes to be passive: the picture of one who
  // is alone.
  return facts != nullptr && picture.damage() == 0 && facts->state.tx_errors.value_or(0) >= kPassive &&
         facts->state.rx_errors.value_or(0) < kWarning && facts->state.health == LinkHealth::error_passive;
}

/// Errors that the controller counted meanwhile, where its driver sends no error frames.
std::uint32_t counted_errors(const LinkFacts* facts) {
  if (facts == nullptr || !facts->before || !facts->before->history || !facts->state.history) return 0;
  return facts->state.history->bus_errors - facts->before->history->bus_errors;
}

bool is_passive_receiver(const LinkFacts* facts) {
  return facts != nullptr && facts->state.rx_errors.value_or(0) >= kWarning;
}

void add_alone(std::vector<Finding>& out, const BusPicture& picture, const LinkFacts* facts,
               std::string_view url) {
  out.push_back(
      {Level::fault, "nobody-acknowledges",
       picture.unacknowledged() > 0
           ? formatted("nobody acknowledges: {} frames in vain", picture.unacknowledged())
           : formatted("nobody acknowledges: error counter tx {}, nothing was received",
                       *facts->state.tx_errors),
       "it is alone on the bus: the drives have no power, the plug or the cable is open, or they have another bitrate",
       formatted(
           "check power and plug, and measure 60 ohm between CAN_H and CAN_L with the power off; then {}",
           find_bitrate(facts, url))});
}

void add_wrong_bitrate(std::vector<Finding>& out, const BusPicture& picture, const LinkFacts* facts,
                       std::string_view url) {
  const auto count = picture.damage() + counted_errors(facts);
  auto text = picture.damage() > 0 ? picture.damage_text() : formatted("{} errors", count);
  if (count == 0) text = formatted("error counter rx {}", facts->state.rx_errors.value_or(0));
  const auto means =
      facts != nullptr && facts->state.bitrate
          ? formatted(
                "somebody talks, and nothing of it can be read: another bitrate than {}; seldom CAN_H and "
                "CAN_L crossed, or no terminator at all",
                drive::bitrate_text(*facts->state.bitrate))
          : std::string(
                "somebody talks, and nothing of it can be read: another bitrate; seldom CAN_H and CAN_L "
                "crossed, or no terminator at all");
  out.push_back({Level::fault, "wrong-bitrate", formatted("errors and not one frame: {}", text), means,
                 bitrate_search(facts != nullptr ? std::string_view(facts->name) : url)});
}

void add_damage(std::vector<Finding>& out, const BusPicture& picture, const LinkFacts* facts) {
  const auto count = picture.damage() > 0 ? picture.damage() : counted_errors(facts);
  const auto text = picture.damage() > 0 ? picture.damage_text() : formatted("{} errors", count);
  const double share = 100.0 * static_cast<double>(count) / static_cast<double>(count + picture.frames());
  out.push_back(
      {Level::fault, "damaged-frames",
       formatted("frames and errors mixed: {} among {} frames ({:.1f} %)", text, picture.frames(), share),
       "the bitrate is right, and the signal is bad: that is what a missing or a third terminator looks like, a long "
       "stub, an open shield, a common ground that is missing, or one node with another bitrate or sample point",
       "with the power off measure 60 ohm between CAN_H and CAN_L: 120 means that one terminator is missing, 40 that "
       "there is one too many; then unplug one node after the other until the errors are gone"});
}

void add_wires(std::vector<Finding>& out, const BusPicture& picture) {
  if (picture.wires().empty()) return;
  out.push_back({Level::fault, "wires", formatted("the transceiver reports: {}", picture.wires()),
                 "a wire is open or has a short: frames are damaged, or do not pass at all",
                 "check the two wires at the plug of the adapter and at each node"});
}

void add_state(std::vector<Finding>& out, const BusPicture& picture, const LinkFacts* facts) {
  if (picture.reports(ControllerReport::bus_off) > 0 &&
      (facts == nullptr || facts->state.health != LinkHealth::bus_off))
    out.push_back({Level::fault, "bus-off", "the controller left the bus meanwhile (bus-off) and came back",
                   "too many errors while it sent", "check bitrate, wiring and the 120 ohm at both ends"});
  const bool passive = picture.reports(ControllerReport::error_passive) > 0 ||
                       (facts != nullptr && facts->state.health == LinkHealth::error_passive);
  if (passive)
    out.push_back(
        {Level::fault, "error-passive", "the controller is or was error-passive",
         "an error counter is or was above 127: it no longer marks frames of others that it sees damaged",
         "check bitrate, wiring and the 120 ohm at both ends; it goes back by itself as good frames come"});
  else if (facts != nullptr && facts->state.health == LinkHealth::error_warning)
    out.push_back(
        {Level::note, "error-warning", "an error counter of the controller is at 96 or more",
         "errors let it rise, each good frame lets it fall: there were many errors, now or a moment ago",
         "look again in a minute; if it has not fallen, check bitrate, wiring and the 120 ohm at both ends"});
}

void add_load(std::vector<Finding>& out, const BusPicture& picture, const LinkFacts* facts) {
  const auto overrun = facts != nullptr && facts->before
                           ? facts->state.traffic.overrun - facts->before->traffic.overrun
                           : std::uint64_t{0};
  if (picture.reports(ControllerReport::overflow) > 0 || overrun > 0)
    out.push_back({Level::fault, "overrun", "frames were lost because nobody took them in time",
                   "the machine, its adapter or its USB is slower than the bus",
                   "fewer programs, another USB port, fewer TPDOs or longer event timers"});
  const auto load = picture.load();
  if (!load || *load < kHighLoad) return;
  const auto peak = picture.peak_load().value_or(*load);
  out.push_back(
      {*load >= kOverload ? Level::fault : Level::note, "load",
       formatted("the bus is loaded to {:.0f} %, {:.0f} % at its peak", *load, peak),
       "frames of low priority (SDO, heartbeat) wait long or for ever",
       "`monitor --table` shows who sends most; fewer TPDOs, longer inhibit and event times, or a higher "
       "bitrate for all"});
}

void add_duplicates(std::vector<Finding>& out, const BusPicture& picture) {
  for (std::uint8_t node = 1; node <= 127; ++node)
    if (const auto& noticed = picture.duplicates().noticed(node); !noticed.empty())
      out.push_back(two_nodes(node, noticed));
}

void add_heard(std::vector<Finding>& out, const BusPicture& picture, const LinkFacts* facts) {
  const auto time = in_seconds(picture.length());
  if (picture.frames() == 0) {
    out.push_back({Level::note, "silence", formatted("nothing was heard in {} s", plain_number(time, 3)),
                   "drives without heartbeat and PDOs are silent until they are asked",
                   ask_the_silent(facts)});
    return;
  }
  auto text = formatted("{} frames in {} s", picture.frames(), plain_number(time, 3));
  if (const auto load = picture.load()) text += formatted(", load {:.1f} %", *load);
  if (!picture.nodes().empty()) text += formatted("; alive: node {}", fmt::join(picture.nodes(), ", "));
  out.push_back({Level::ok, "traffic", std::move(text), {}, {}});
  if (picture.extended() > 0)
    out.push_back(
        {Level::note, "foreign-frames", formatted("{} frames have 29-bit identifiers", picture.extended()),
         "of CANopen only PDOs can have them: PDOs that were set so, or another protocol on this bus",
         "`pdo show -n NODE` shows the CAN-IDs that a drive has for its PDOs, `monitor` the frames; where another device "
         "is to be on this bus, the load is all that it costs"});
}

}  // namespace

void add_fd_frames(std::vector<Finding>& findings, std::string text) {
  std::erase_if(findings, [](const Finding& finding) { return finding.code == "silence"; });
  findings.push_back(
      {Level::note, "fd-frames", std::move(text),
       "CANopen FD, or another protocol: servoctl counts these frames and does not read them",
       "set the drives to classical CAN, if they are to be used with servoctl; a controller without CAN FD "
       "on this bus destroys such frames"});
}

std::vector<Finding> bus_findings(const BusPicture& picture, const LinkFacts* facts, std::string_view url) {
  std::vector<Finding> out;
  const bool alone = sends_in_vain(picture, facts);
  const bool damaged = picture.damage() > 0 || counted_errors(facts) > 0 || is_passive_receiver(facts);
  if (alone)
    add_alone(out, picture, facts, url);
  else if (damaged && picture.frames() == 0)
    add_wrong_bitrate(out, picture, facts, url);
  else if (picture.damage() > 0 || counted_errors(facts) > 0)
    add_damage(out, picture, facts);
  if (!alone && (!damaged || picture.frames() > 0)) add_heard(out, picture, facts);
  add_wires(out, picture);
  add_state(out, picture, facts);
  add_load(out, picture, facts);
  add_duplicates(out, picture);
  return out;
}

}  // namespace servoctl::traffic
