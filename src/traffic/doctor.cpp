#include "traffic/doctor.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "base/format.hpp"
#include "base/text.hpp"
#include "can/link_change.hpp"
#include "can/serial_port.hpp"
#include "can/socketcan.hpp"
#include "canopen/cob_id.hpp"
#include "session/can_network.hpp"
#include "session/ethercat_network.hpp"
#include "session/open_network.hpp"
#include "session/scan.hpp"
#include "session/stretch.hpp"
#include "traffic/link_findings.hpp"
#include "traffic/listening.hpp"
#include "traffic/ring_findings.hpp"

namespace servoctl::traffic {
namespace {

using Level = Finding::Level;

constexpr Duration kLookAgain = std::chrono::milliseconds(50);
constexpr Duration kLongestRest = std::chrono::milliseconds(500);

void add(std::vector<Finding>& to, std::vector<Finding> more) {
  std::move(more.begin(), more.end(), std::back_inserter(to));
}

bool is_own_request(const can::Frame& frame) {
  return !frame.error && !frame.extended && frame.id > canopen::kSdoRequest &&
         frame.id <= canopen::kSdoRequest + canopen::kLastNode;
}

/// Everything that is to be heard, until the time is over.
Result<void> hear_all(can::Bus& bus, BusPicture& picture, const DoctorOptions& options) {
  const auto begin = bus.now();
  const auto end = begin + options.listen;
  while (bus.now() < end && !(options.cancelled && options.cancelled())) {
    if (options.told)
      options.told(std::chrono::duration<double>(bus.now() - begin) / options.listen, begin, bus.now());
    const auto frame = bus.receive(std::min(end, bus.now() + kLookAgain));
    if (!frame) return fail(frame.error());
    if (*frame) picture.add(**frame, bus.arrived());
  }
  picture.end(bus.now());
  return {};
}

/// What was heard while servoctl asked; what it sent itself is no sign of life. On a bus that is never silent
/// there is no last frame.
Result<void> hear_rest(can::Bus& bus, BusPicture& picture) {
  const auto end = bus.now() + kLongestRest;
  while (bus.now() < end) {
    const auto frame = bus.receive(bus.now());
    if (!frame) return fail(frame.error());
    if (!*frame) break;
    if (!is_own_request(**frame)) picture.add(**frame, bus.arrived());
  }
  picture.end(bus.now());
  return {};
}

/// `sim:` and `local:` have no bitrate that could be another.
std::string look_for_all(const std::string& url) {
  if (url.starts_with("sim:") || url.starts_with("local:"))
    return "`nmt preop -n all` if they may be stopped; else check power and cable";
  return formatted("`nmt preop -n all` if they may be stopped; else check power and cable; {}",
                   bitrate_search(url));
}

/// Asks all nodes for 1000h; who answers, and who answers twice.
Result<std::vector<Finding>> ask_all(session::Session& session) {
  const auto found = session::nodes_present(session);
  if (!found && found.error().code == Errc::interrupted) return fail(found.error());
  if (!found && found.error().code != Errc::timeout)
    return std::vector<Finding>{{Level::fault, "cannot-send", found.error().message.text(),
                                 "the question did not get through", found.error().hint.text()}};
  if (!found)
    return std::vector<Finding>{{Level::fault, "no-node", "no node answered a read of 1000h",
                                 "no power, no cable, another bitrate, or all of them are stopped (NMT)",
                                 look_for_all(session.url())}};
  std::string list;
  for (const auto node : *found) append(list, formatted("{}", node));
  std::vector<Finding> out{{Level::ok, "nodes", formatted("answered: node {}", list), {}, {}}};
  auto* can = session.can();
  if (can == nullptr) return out;
  for (const auto node : *found)
    if (const auto& noticed = can->duplicates().noticed(node); !noticed.empty())
      out.push_back(two_nodes(node, noticed));
  return out;
}

/// Silence is no more to be mended by asking where they were asked.
void drop_advice(std::vector<Finding>& findings) {
  for (auto& finding : findings)
    if (finding.code == "silence") finding.mend = "they were polled; the answers are below";
}

Result<std::vector<Finding>> ask_over(const std::string& name, const DoctorOptions& options) {
  auto network = session::open_network(name, {});
  if (!network) return fail(network.error());
  session::Options how;
  how.cancelled = options.cancelled;
  session::Session session(std::move(*network), name, std::move(how));
  auto out = ask_all(session);
  (void)session.close();
  return out;
}

LinkFacts facts_of(const std::string& name, const can::LinkState& state) {
  return {.name = name,
          .state = state,
          .driver = can::link_driver(name),
          .may_change = can::may_change_links(),
          .receivers = can::link_receivers(name)};
}

/// Listens, asks if it may, and says what it was.
Result<std::vector<Finding>> hear_link(can::LinkControl& link, LinkFacts& facts,
                                       const DoctorOptions& options) {
  const auto bus = link.listen();
  if (!bus) return fail(bus.error());
  BusPicture picture(facts.state.bitrate.value_or(0), (*bus)->now());
  if (const auto heard = hear_all(**bus, picture, options); !heard) return fail(heard.error());
  std::vector<Finding> asked;
  if (options.active && !facts.state.listen_only) {
    auto answers = ask_over(link.name(), options);
    if (!answers) return fail(answers.error());
    asked = std::move(*answers);
    if (const auto heard = hear_rest(**bus, picture); !heard) return fail(heard.error());
  }
  facts.before = facts.state;
  const auto after = link.state();
  if (!after) return fail(after.error());
  facts.state = *after;
  auto out = bus_findings(picture, &facts);
  const auto notices = (*bus)->take_notices();
  if (!notices.empty()) add_fd_frames(out, notices.front().text());
  if (!asked.empty()) drop_advice(out);
  add(out, std::move(asked));
  return out;
}

Result<Findings> examine_ring(session::Session& session, session::EtherCatNetwork& ring,
                              const DoctorOptions& options) {
  Findings out{session.url()};
  RingFacts facts;
  const auto before = ring.statistics();
  const auto begin = session.now();
  auto seen = ring.look(false);
  if (!seen) {
    if (seen.error().code == Errc::interrupted) return fail(seen.error());
    const auto colon = session.url().find(':');
    const auto link = can::socketcan_carrier(session.url().substr(colon + 1));
    out.list.push_back(no_ring(session.url(), link, seen.error()));
    return out;
  }
  facts.first = facts.last = *seen;
  facts.least = facts.most = seen->size();
  const session::Stretch stretch(session, begin + options.listen);
  while (session.now() < begin + options.listen && !(options.cancelled && options.cancelled())) {
    const auto waited = session.wait([] { return false; }, session.now() + std::chrono::milliseconds(200));
    if (!waited) break;
    seen = ring.look(false);
    facts.least = std::min(facts.least, seen ? seen->size() : 0);
    facts.most = std::max(facts.most, seen ? seen->size() : 0);
    if (seen) facts.last = *seen;
  }
  facts.length = session.now() - begin;
  const auto& after = ring.statistics();
  facts.sent = after.sent - before.sent;
  facts.lost = after.lost - before.lost;
  facts.damaged = after.damaged - before.damaged;
  add(out.list, ring_findings(facts));
  return out;
}

}  // namespace

Result<Findings> examine_link(const std::string& name, const DoctorOptions& options) {
  Findings out{name};
  if (!can::is_interface(name)) {
    out.list.push_back(
        {Level::fault, "no-interface", formatted("there is no interface {}", name),
         "no adapter is plugged in under this name, or it has no driver",
         "`bus status` lists those that there are; plug it in, then `sudo dmesg` says whether it was seen"});
    return out;
  }
  const auto link = can::open_link(name);
  if (!link) return fail(link.error());
  const auto state = (*link)->state();
  if (!state) return fail(state.error());
  auto facts = facts_of(name, *state);
  std::vector<Finding> heard;
  const bool off = state->health == can::LinkHealth::bus_off;
  if (state->up && !off) {
    auto told = hear_link(**link, facts, options);
    if (!told) return fail(told.error());
    heard = std::move(*told);
  }
  add(out.list, link_findings(facts));
  add(out.list, std::move(heard));
  return out;
}

Result<Findings> examine(session::Session& session, const DoctorOptions& options) {
  if (auto* ring = session.ethercat()) return examine_ring(session, *ring, options);
  Findings out{session.url()};
  BusPicture picture(session::bitrate_of(session.url()).value_or(0), session.now());
  Listener listener;
  listener.on_frame = [&](const can::Frame& frame, TimePoint time) { picture.add(frame, time); };
  if (const auto heard = listen(session, options.listen, listener); !heard) return fail(heard.error());
  picture.end(session.now());
  if (auto* const can = session.can())
    if (auto about = can->bus().about(); !about.empty())
      out.list.push_back({Level::ok, "adapter", std::move(about), {}, {}});
  add(out.list, bus_findings(picture, nullptr, session.url()));
  if (!options.active) return out;
  auto asked = ask_all(session);
  if (!asked) return fail(asked.error());
  drop_advice(out.list);
  add(out.list, std::move(*asked));
  return out;
}

Findings examine_machine() {
  std::error_code error;
  const bool has_can =
      std::filesystem::exists("/proc/net/can", error) || std::filesystem::exists("/sys/module/can", error);
  return {"", no_interface_findings(has_can, can::serial_adapters())};
}

}  // namespace servoctl::traffic
