#include "traffic/ring_findings.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::traffic {
namespace {

using Level = Finding::Level;
using Seen = session::EtherCatNetwork::Seen;

/// Counters stop at 255.
constexpr unsigned kEnd = 255;

void add_count(std::string& out, unsigned number, std::string_view what) {
  if (number > 0) append(out, formatted("{}{} {}", number, number == kEnd ? " or more" : "", what));
}

template <class Port>
std::string errors_of(const Port& port) {
  std::string out;
  add_count(out, port.bad_frames, "bad frames (CRC)");
  add_count(out, port.bad_symbols, "bad symbols");
  add_count(out, port.lost_links, "lost links");
  return out;
}

template <class Port>
bool counts_on(const Port& before, const Port& after) {
  return after.bad_frames != before.bad_frames || after.bad_symbols != before.bad_symbols ||
         after.lost_links != before.lost_links;
}

/// Where a counter goes on while it is looked at, something is wrong now; else it was.
void add_ports(std::vector<Finding>& out, std::size_t node, const Seen& first, const Seen& last) {
  for (std::size_t port = 0; port < last.look.ports.size(); ++port) {
    const auto& after = last.look.ports[port];
    const auto& before = first.look.ports[port];
    const auto text = errors_of(after);
    const bool now = counts_on(before, after);
    if (!text.empty())
      out.push_back({now ? Level::fault : Level::note, now ? "port-errors" : "port-had-errors",
                     formatted("node {}, port {}: {}{}", node, port, text, now ? ", and counting" : ""),
                     now ? "the link at this port fails, or frames are damaged on its cable"
                         : "counted since the drive was switched on; none came meanwhile",
                     formatted("check plug and cable at this port of node {} and at its neighbour", node)});
    if (after.link && !after.open)
      out.push_back(
          {Level::fault, "port-closed",
           formatted("node {}, port {}: a cable is plugged in, but frames do not go out there", node, port),
           "what stands behind it is not reached", "check the slave at the other end of that cable"});
  }
}

void add_count_of_slaves(std::vector<Finding>& out, const RingFacts& facts) {
  if (facts.least == facts.most) {
    out.push_back(
        {Level::ok,
         "slaves",
         formatted("{} slave{} on the ring all the time ({} s)", facts.most, facts.most == 1 ? "" : "s",
                   plain_number(std::chrono::duration<double>(facts.length).count(), 3)),
         {},
         {}});
    return;
  }
  out.push_back({Level::fault, "slaves-come-and-go",
                 formatted("between {} and {} slaves answered", facts.least, facts.most),
                 formatted("node {} and those behind it come and go: a loose plug, or a drive that restarts",
                           facts.least + 1),
                 facts.least == 0
                     ? std::string("check power of node 1 and the cable between this machine and node 1")
                     : formatted("check power of node {} and the cable between node {} and node {}",
                                 facts.least + 1, facts.least, facts.least + 1)});
}

void add_frames(std::vector<Finding>& out, const RingFacts& facts) {
  if (facts.lost == 0 && facts.damaged == 0) return;
  out.push_back({Level::fault, "lost-frames",
                 formatted("{} of {} frames did not come back, {} came back damaged", facts.lost, facts.sent,
                           facts.damaged),
                 "a cable or plug of the ring, or a network card that is used by something else too",
                 "the port whose counters go on tells where; `scan` lists them"});
}

}  // namespace

std::vector<Finding> ring_findings(const RingFacts& facts) {
  std::vector<Finding> out;
  add_count_of_slaves(out, facts);
  add_frames(out, facts);
  for (std::size_t i = 0; i < std::min(facts.first.size(), facts.last.size()); ++i) {
    add_ports(out, i + 1, facts.first[i], facts.last[i]);
    if (facts.last[i].look.al.error)
      out.push_back({Level::fault, "al-error", formatted("node {} reports an error of its AL state", i + 1),
                     "it has left the state it was to be in", formatted("`status -n {}` names it", i + 1)});
  }
  return out;
}

Finding no_ring(const std::string& url, std::optional<bool> link, const Error& error) {
  if (link == false)
    return {Level::fault, "no-link", formatted("{} has no link", url), "no cable, or nobody at its other end",
            "check the cable to the first slave (its IN), and that the slave has power"};
  return {
      Level::fault, "no-answer", error.message.text(),
      "the port works, and no slave answers: the wrong port, no power, or the cable is in the OUT of the first slave",
      error.hint.text()};
}

}  // namespace servoctl::traffic
