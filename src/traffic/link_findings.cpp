#include "traffic/link_findings.hpp"

#include <fmt/format.h>

#include "base/format.hpp"
#include "can/link_change.hpp"
#include "drive/bitrate.hpp"

namespace servoctl::traffic {
namespace {

using Level = Finding::Level;
using can::LinkHealth;

std::string up_line(const LinkFacts& facts) {
  if (facts.state.kind != "can") return formatted("`bus up {}`", facts.name);
  if (facts.state.bitrate) return formatted("`bus up {}`, or with another --bitrate", facts.name);
  return formatted(
      "`bus up {0} --bitrate 500k`, with the bitrate of the drives; where nobody knows it: `bus detect {0}`",
      facts.name);
}

std::string state_text(const LinkFacts& facts) {
  const auto& state = facts.state;
  auto out = state.up ? formatted("{} is up", facts.name) : formatted("{} is down", facts.name);
  if (state.bitrate) out += ", " + drive::bitrate_text(*state.bitrate);
  if (state.bitrate && state.sample_point)
    out += formatted(", sample point {:.1f} %", *state.sample_point / 10.0);
  if (state.up && state.health) out += formatted(", {}", can::name(*state.health));
  if (state.up && state.tx_errors && state.rx_errors)
    out += formatted(", error counters tx {} rx {}", *state.tx_errors, *state.rx_errors);
  return out + formatted(" ({})", facts.driver.empty() ? state.kind : facts.driver);
}

void add_mode(std::vector<Finding>& out, const LinkFacts& facts) {
  if (facts.state.listen_only)
    out.push_back(
        {Level::fault, "listen-only", formatted("{} only listens", facts.name),
         "it sends nothing and acknowledges nothing: a drive that is alone with it cannot send either",
         formatted("`bus up {}` ends it", facts.name)});
  if (facts.state.loopback)
    out.push_back({Level::fault, "loopback", formatted("{} is in loopback mode", facts.name),
                   "what it sends does not reach the bus",
                   formatted("`sudo ip link set {0} down`, `sudo ip link set {0} up type can loopback off`",
                             facts.name)});
}

/// CiA 301, 5.3: 75 to 90 % from 800 kbit/s on, 85 to 90 % below.
void add_sample_point(std::vector<Finding>& out, const LinkFacts& facts) {
  const auto& state = facts.state;
  if (!state.bitrate || !state.sample_point) return;
  const int least = *state.bitrate >= 800'000 ? 750 : 850;
  if (*state.sample_point >= least && *state.sample_point <= 900) return;
  out.push_back({Level::note, "sample-point",
                 formatted("the sample point is at {:.1f} %; CiA 301 has {} to 90 % at {}",
                           *state.sample_point / 10.0, least / 10, drive::bitrate_text(*state.bitrate)),
                 "long cables and drives that sample elsewhere may cause errors with it",
                 formatted("`bus up {} --bitrate {} --sample-point 0.875`", facts.name, *state.bitrate)});
}

void add_restart(std::vector<Finding>& out, const LinkFacts& facts) {
  if (facts.state.restart_ms != 0U || !facts.state.bitrate) return;
  out.push_back(
      {Level::note, "no-restart", "after a bus-off it does not come back by itself (restart-ms 0)",
       "whoever uses it then has lost its bus until somebody restarts it",
       formatted("`bus up {}` behind a bus-off; always: `bus up {} --restart-ms 100`, where its driver can",
                 facts.name, facts.name)});
}

void add_queue(std::vector<Finding>& out, const LinkFacts& facts) {
  constexpr std::uint32_t kShort = 100;
  if (facts.state.queue_length >= kShort || facts.state.kind != "can") return;
  out.push_back({Level::note, "short-queue",
                 formatted("its queue holds {} frames that wait to be sent", facts.state.queue_length),
                 "servoctl waits when it is full; other programs end with \"No buffer space available\"",
                 formatted("`bus up {} --txqueuelen 1000`", facts.name)});
}

void add_termination(std::vector<Finding>& out, const LinkFacts& facts) {
  if (!facts.state.termination) return;
  const auto ohm = *facts.state.termination;
  out.push_back(
      {Level::note, "termination",
       ohm == 0 ? "the terminator of the adapter is off"
                : formatted("the adapter terminates the bus itself with {} ohm", ohm),
       "a bus has two terminators, one at each end",
       formatted("`sudo ip link set {} type can termination {}` while it is down, where that end is to be so",
                 facts.name, ohm == 0 ? 120 : 0)});
}

void add_health(std::vector<Finding>& out, const LinkFacts& facts) {
  if (facts.state.health != LinkHealth::bus_off && facts.state.health != LinkHealth::stopped) return;
  out.push_back(
      {Level::fault, "bus-off", formatted("the controller is {}", can::name(*facts.state.health)),
       "it has left the bus after too many errors while it sent: another bitrate than the others, CAN_H and "
       "CAN_L crossed or shorted, no terminator",
       formatted("check those, then `bus up {}`", facts.name)});
}

void add_history(std::vector<Finding>& out, const LinkFacts& facts) {
  if (!facts.state.history || facts.state.history->bus_off == 0) return;
  out.push_back(
      {Level::note, "was-bus-off",
       formatted("it was bus-off {} time{} since its driver was loaded", facts.state.history->bus_off,
                 facts.state.history->bus_off == 1 ? "" : "s"),
       "a loose plug, a wrong bitrate or a missing terminator, now or earlier",
       formatted("`bus status {}` shows whether the count goes on; if so, check plugs, bitrate and the "
                 "120 ohm at both ends",
                 facts.name)});
}

/// An adapter that is a serial port is no interface of the kernel, and needs none.
std::string serial_port_text(const std::vector<std::string>& ports) {
  if (ports.empty())
    return "an adapter that is a serial port (slcan) needs neither driver nor root: `scan -b slcan:PORT@500k`; "
           "none is plugged in now";
  return formatted(
      "an adapter that is a serial port (slcan) needs neither driver nor root: `scan -b slcan:{}@500k`, "
      "with the bitrate of the drives; USB serial ports: {}",
      ports.front(), fmt::join(ports, ", "));
}

}  // namespace

std::vector<Finding> link_findings(const LinkFacts& facts) {
  std::vector<Finding> out;
  if (!facts.state.up) {
    out.push_back({Level::fault, "down", state_text(facts), "nothing is sent or received", up_line(facts)});
  } else {
    out.push_back({Level::ok, "up", state_text(facts), {}, {}});
    add_health(out, facts);
    add_mode(out, facts);
    add_sample_point(out, facts);
    add_restart(out, facts);
    add_queue(out, facts);
    add_termination(out, facts);
    add_history(out, facts);
  }
  if (facts.may_change == false)
    out.push_back({Level::note, "no-right", "this user may not change the interface (CAP_NET_ADMIN)",
                   "`bus up`, `bus down` and `bus detect` need it; reading and writing drives do not",
                   can::right_command()});
  return out;
}

std::vector<Finding> no_interface_findings(bool kernel_has_can, const std::vector<std::string>& serial) {
  const auto by_serial_port = serial_port_text(serial);
  if (!kernel_has_can)
    return {{Level::fault, "no-kernel-can", "the kernel has no CAN",
             "no adapter that needs a driver of the kernel can work; one that is a serial port (slcan) can",
             formatted("`sudo modprobe can-raw`; {}; without any adapter: `--bus sim:FAMILY@1`",
                       by_serial_port)}};
  return {
      {Level::fault, "no-adapter", "this machine has no CAN interface",
       "no adapter is plugged in, or it has no driver, or it is a serial port (slcan)",
       "plug it in, then `lsusb` or `lspci` and `sudo dmesg` say whether it was seen; " + by_serial_port}};
}

}  // namespace servoctl::traffic
