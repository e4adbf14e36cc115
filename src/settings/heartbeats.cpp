#include "settings/heartbeats.hpp"

#include <algorithm>
#include <set>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/node_id.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "session/option_scope.hpp"

namespace servoctl::settings {
namespace {

using session::WatchedNode;

constexpr Duration kLongest = std::chrono::milliseconds(65'535);
constexpr std::string_view kWatchHint = "NODE=TIME, such as 3=300ms; 3=off ends it";

/// What is known of a producer without making anybody wait for one that is not there.
std::optional<Duration> period_of(session::Session& session, std::uint8_t node) {
  const session::Hurry hurry(session, std::chrono::milliseconds(100), 0);
  const auto value = session.upload(node, objects::kProducerHeartbeat);
  if (!value) return std::nullopt;
  return std::chrono::milliseconds(load_le(*value) & 0xFFFFU);
}

/// A consumer that is quicker than its producer raises an alarm at once (CiA 301, 7.5.2.19).
Result<void> hold_against_producer(show::Desk& desk, std::uint8_t node, const HeartbeatWatch& watch) {
  const auto period = period_of(*desk.session, watch.node);
  if (!period) {
    desk.notices.push_back(
        message("node {}: node {} does not tell its heartbeat period: make sure that it is well below {}",
                node_name(node), node_name(watch.node), to_string(watch.time)));
    return {};
  }
  if (*period == Duration::zero()) {
    desk.notices.push_back(
        message("node {}: node {} sends no heartbeat yet; it is watched from its first one on "
                "(`heartbeat set 100ms -n {}`)",
                node_name(node), node_name(watch.node), node_name(watch.node)));
    return {};
  }
  if (watch.time <= *period)
    return fail(drive_error(Errc::refused, node, {objects::kConsumerHeartbeatIndex, 0},
                            message("node {} sends a heartbeat every {}: {} is too short for it",
                                    node_name(watch.node), to_string(*period), to_string(watch.time)),
                            "one and a half periods at least"));
  if (2 * watch.time < 3 * *period)
    desk.notices.push_back(message("node {}: {} is less than one and a half periods of node {} ({})",
                                   node_name(node), to_string(watch.time), node_name(watch.node),
                                   to_string(*period)));
  return {};
}

Result<Change> entry_change(show::Desk& desk, std::uint8_t node, std::uint8_t sub,
                            const HeartbeatWatch& watch) {
  const auto target = drive::target_at(desk.profile, {objects::kConsumerHeartbeatIndex, sub});
  return make_change(desk, node, target, std::to_string(session::consumer_entry(watch.node, watch.time)), {});
}

Result<void> check_watches(std::uint8_t node, std::span<const HeartbeatWatch> watches) {
  std::set<std::uint8_t> seen;
  for (const auto& watch : watches) {
    if (watch.node == node)
      return fail(Errc::usage, message("node {} cannot watch its own heartbeat", node_name(node)),
                  "name another node");
    if (!seen.insert(watch.node).second)
      return fail(Errc::usage, message("node {} appears twice", node_name(watch.node)), "one time a node");
  }
  return {};
}

/// The entry that a node has, or else the first that is free; null where neither is.
WatchedNode* entry_for(std::vector<WatchedNode>& entries, std::uint8_t producer) {
  const auto of = [&](std::uint8_t node) {
    return std::find_if(entries.begin(), entries.end(), [&](const auto& e) { return e.node == node; });
  };
  auto found = of(producer);
  if (found == entries.end()) found = of(0);
  return found == entries.end() ? nullptr : &*found;
}

}  // namespace

Result<Duration> parse_heartbeat_time(std::string_view text) {
  if (equals_nocase(text, "off") || text == "0") return Duration::zero();
  const auto time = read_duration(text);
  if (!time) return time;
  if (*time > kLongest || *time % std::chrono::milliseconds(1) != Duration::zero())
    return fail(Errc::usage, message("'{}' is no time of a heartbeat", as_it_is(text)),
                "whole milliseconds, up to 65535ms; off for none");
  return time;
}

Result<HeartbeatWatch> parse_heartbeat_watch(std::string_view text) {
  const auto equals = text.find('=');
  const auto number = equals == std::string_view::npos ? std::nullopt : parse_integer(text.substr(0, equals));
  const auto node = number ? number->as_unsigned() : std::nullopt;
  if (!node || *node < canopen::kFirstNode || *node > canopen::kLastNode)
    return fail(Errc::usage, message("'{}' is not a node and a time", as_it_is(text)),
                std::string(kWatchHint));
  const auto time = parse_heartbeat_time(text.substr(equals + 1));
  if (!time) return fail(time.error());
  return HeartbeatWatch{static_cast<std::uint8_t>(*node), *time};
}

Result<Change> producer_change(show::Desk& desk, std::uint8_t node, Duration time) {
  const auto object = objects::kProducerHeartbeat;
  const bool is_known = desk.profile != nullptr;
  if (is_known && desk.profile->dictionary.find(object) == nullptr)
    return fail(Errc::usage,
                message("a {} has no 1017h: it sends no heartbeat", as_it_is(desk.profile->family)),
                "node guarding asks it instead: `nmt watch --guard 200ms`");
  const auto count = std::chrono::duration_cast<std::chrono::milliseconds>(time).count();
  // Without a family the object is as CiA 301 has it.
  const auto type = is_known ? std::nullopt : std::optional(od::DataType::u16);
  return make_change(desk, node, drive::target_at(desk.profile, object), std::to_string(count), type);
}

Result<std::vector<Change>> consumer_changes(show::Desk& desk, std::uint8_t node,
                                             std::span<const HeartbeatWatch> watches) {
  if (const auto right = check_watches(node, watches); !right) return fail(right.error());
  const std::uint8_t nodes[] = {node};
  const auto now = session::read_supervision(*desk.session, *desk.profile, nodes).front();
  if (!now) return fail(now.error());
  if (now->entries.empty())
    return fail(
        drive_error(Errc::usage, node, {objects::kConsumerHeartbeatIndex, 0},
                    message("a {} watches no heartbeat: it has no 1016h", as_it_is(desk.profile->family)),
                    "`watchdog` shows what it does without its master"));
  auto entries = now->entries;
  std::vector<Change> out;
  for (const auto& watch : watches) {
    auto* entry = entry_for(entries, watch.node);
    const bool ends = watch.time == Duration::zero();
    if (ends && (entry == nullptr || entry->node != watch.node)) {
      desk.notices.push_back(
          message("node {}: it does not watch node {}", node_name(node), node_name(watch.node)));
      continue;
    }
    if (entry == nullptr)
      return fail(drive_error(Errc::refused, node, {objects::kConsumerHeartbeatIndex, 0},
                              message("all {} entries are taken", entries.size()),
                              "`heartbeat show` lists them; NODE=off frees one"));
    if (!ends)
      if (const auto fits = hold_against_producer(desk, node, watch); !fits) return fail(fits.error());
    auto change = entry_change(desk, node, entry->sub, ends ? HeartbeatWatch{} : watch);
    if (!change) return fail(change.error());
    // One that was freed by this line is written once, with what it is to hold in the end.
    std::erase_if(out, [&](const Change& other) { return other.target.address == change->target.address; });
    out.push_back(std::move(*change));
    *entry = {entry->sub, ends ? std::uint8_t{0} : watch.node, watch.time};
  }
  return out;
}

}  // namespace servoctl::settings
