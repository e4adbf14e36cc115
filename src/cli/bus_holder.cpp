#include "cli/bus_holder.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "base/printable.hpp"
#include "base/signal_wait.hpp"
#include "base/text.hpp"
#include "can/descriptor.hpp"
#include "can/socketcan.hpp"
#include "motion/left_energised.hpp"
#include "motion/power.hpp"
#include "session/can_network.hpp"
#include "session/link_wait.hpp"
#include "session/open_network.hpp"
#include "session/open_port.hpp"
#include "session/serve_registers.hpp"
#include "session/serve_ring.hpp"
#include "traffic/sync_end.hpp"

namespace servoctl::cli {
namespace {

/// Between two tries to open a bus that is lost, and two lines about it.
constexpr Duration kReconnectPause = std::chrono::milliseconds(10);
constexpr Duration kTelling = std::chrono::seconds(1);

}  // namespace

Result<session::Session*> BusHolder::open(const Settings& settings) {
  if (settings.bus.empty())
    return fail(Errc::usage, "which bus?", bus_hint(can::can_interfaces(), session::ethercat_links()));
  const auto url = session::canonical_url(settings.bus);
  const bool traces_anew = bus_options_.trace != settings.trace;
  for (auto* session : sessions()) {
    const bool same = session::canonical_url(session->url()) == url;
    if (!traces_anew && (same || settings.of_cabinet)) continue;
    stop_and_disable(*session);
    stop_sync(*session);
    drop(*session);
  }
  if (!open_.empty() && !settings.trace.empty() && open_.count(url) == 0)
    return fail(Errc::usage, "--trace records one bus, and this line needs several",
                "name the axes of one bus");
  bus_options_.trace = settings.trace;
  if (!settings.names.empty()) names_[url] = settings.names;
  if (const auto found = open_.find(url); found != open_.end())
    session_ = found->second.get();
  else if (auto done = connect(settings.bus); !done)
    return fail(done.error());
  session_->options().timeout = settings.timeout;
  session_->options().retries = settings.retries;
  return session_;
}

std::vector<std::uint8_t> BusHolder::energised_on(std::string_view url) const {
  const auto key = session::canonical_url(url);
  std::vector<std::uint8_t> out;
  if (const auto found = open_.find(key); found != open_.end())
    out.assign(found->second->energised().nodes().begin(), found->second->energised().nodes().end());
  if (const auto left = left_energised_.find(key); left != left_energised_.end())
    out.insert(out.end(), left->second.nodes().begin(), left->second.nodes().end());
  return out;
}

std::vector<session::Session*> BusHolder::sessions() const {
  std::vector<session::Session*> out;
  for (const auto& [url, session] : open_) out.push_back(session.get());
  return out;
}

const show::AxisNames& BusHolder::names(const session::Session& session) const {
  static const show::AxisNames kNone;
  const auto found = names_.find(session::canonical_url(session.url()));
  return found == names_.end() ? kNone : found->second;
}

HeardStates::State BusHolder::heard_state(const session::Session& session, std::uint8_t node) const {
  const auto found = opened_.find(&session);
  return found == opened_.end() ? HeardStates::State() : found->second.heard->state(node);
}

std::uint64_t BusHolder::opening(const session::Session& session) const {
  const auto found = opened_.find(&session);
  return found == opened_.end() ? 0 : found->second.number;
}

Result<std::unique_ptr<session::RingEnd>> BusHolder::open_ring_end(const Settings& settings) {
  bus_options_.trace = settings.trace;
  return session::open_ring_end(settings.bus, bus_options_, options_.cancelled);
}

Result<std::unique_ptr<session::RegisterEnd>> BusHolder::open_register_end(const Settings& settings) {
  bus_options_.trace = settings.trace;
  return session::open_register_end(settings.bus, bus_options_, options_.cancelled);
}

Result<void> BusHolder::connect(const std::string& url) {
  auto network = session::open_network(url, bus_options_);
  if (!network) return fail(network.error());
  auto session = std::make_unique<session::Session>(std::move(*network), url, options_);
  session->options().beside = [this] { return serve_beside(); };
  // Ctrl-C closes no bus that was just opened where a drive is to be stopped behind it.
  const bool must_stop = left_energised_.count(session::canonical_url(url)) > 0;
  if (auto heard = session->listen(); !heard && !(must_stop && heard.error().code == Errc::interrupted))
    return heard;
  // Boot-ups of drives that are simulated in this process are no news.
  (void)session->take_events();
  if (auto left = left_energised_.extract(session::canonical_url(url)))
    session->energised() = std::move(left.mapped());
  session_ = session.get();
  opened_[session_] = {std::make_unique<HeardStates>(*session_), ++openings_};
  open_[session::canonical_url(url)] = std::move(session);
  return {};
}

/// What breaks while a line runs is told at once: a recording may go on for hours.
void BusHolder::on_trace_failed(const Error& error) {
  trace_failure_ = error;
  if (!flushing_)
    console_->err(fmt::format("notice: {}; {}\n", printable(error.message), printable(error.hint)));
}

std::optional<Error> BusHolder::take_trace_failure() {
  flushing_ = true;
  for (auto* session : sessions()) session->network().flush_trace();
  flushing_ = false;
  return std::exchange(trace_failure_, std::nullopt);
}

/// Closes the buses; what is still energised stays known.
void BusHolder::drop() {
  for (auto* session : sessions()) drop(*session);
}

void BusHolder::drop(session::Session& session) {
  const auto url = session::canonical_url(session.url());
  if (!session.energised().empty()) left_energised_.insert_or_assign(url, std::move(session.energised()));
  flushing_ = true;  // What the trace could not take to the last is told by who takes its failure.
  opened_.erase(&session);
  open_.erase(url);
  flushing_ = false;
  session_ = open_.empty() ? nullptr : open_.begin()->second.get();
}

void BusHolder::lose(session::Session& session) {
  for (const auto node : session.energised().nodes()) warn(names(session), node, session.url() + " was lost");
  if (produces_sync(session))
    console_->err(fmt::format("notice: SYNC is no longer produced: {} was lost\n", session.url()));
  drop(session);
}

void BusHolder::let_go() {
  // Taken out only when its bus is there again: what is known to be energised stays protected.
  std::map<std::string, std::set<std::uint8_t>> left;
  for (const auto& [url, nodes] : left_energised_) left[url] = nodes.nodes();
  stop_and_disable();
  stop_sync();
  if (!left.empty()) drop();
  for (const auto& [url, nodes] : left) {
    if (const auto back = connect_again(url, nodes); !back) {
      for (const auto node : nodes) warn(names_[url], node, back.error().message);
      continue;
    }
    stop_and_disable();
    drop();
  }
}

/// A bus that is lost may come back: behind it drives are energised. A signal ends one try to open it, not
/// the patience.
Result<void> BusHolder::connect_again(const std::string& url, const std::set<std::uint8_t>& nodes) {
  const auto end = steady_now() + session::LinkWait::kPatience;
  auto next_line = steady_now();
  // What matters is to stop them: a trace that cannot be written, or would be begun anew, is none of it.
  bus_options_.trace.clear();
  for (;;) {
    auto back = connect(url);
    const auto time = steady_now();
    const bool may_come = !back && (back.error().code == Errc::bus || back.error().code == Errc::interrupted);
    if (!may_come || time >= end) return back;
    if (time >= next_line) {
      console_->note(fmt::format("notice: {}: trying again to stop node{} {}\n", back.error().message,
                                 nodes.size() == 1 ? "" : "s", fmt::join(nodes, ", ")));
      next_line += kTelling;
    }
    can::nap(kReconnectPause);
  }
}

bool BusHolder::produces_sync() const {
  const auto all = sessions();
  return std::any_of(all.begin(), all.end(), [](auto* session) { return produces_sync(*session); });
}

bool BusHolder::produces_sync(session::Session& session) {
  return session.can() != nullptr && session.can()->sync() != nullptr;
}

void BusHolder::stop_sync() {
  for (auto* session : sessions()) stop_sync(*session);
}

void BusHolder::stop_sync(session::Session& session) {
  if (!produces_sync(session)) return;
  const auto count = session.can()->sync()->rhythm.count();
  for (const auto& warning : traffic::end_sync(session).warnings) console_->err("warning: " + warning + "\n");
  console_->note(fmt::format("notice: SYNC is no longer produced on {}, after {}\n", session.url(), count));
}

bool BusHolder::must_go_on() const {
  const auto all = sessions();
  return std::any_of(all.begin(), all.end(), [](auto* session) { return session->network().must_go_on(); });
}

bool BusHolder::holds_drives() const {
  const auto all = sessions();
  return must_go_on() || std::any_of(all.begin(), all.end(), [](auto* session) {
           return session->ethercat() != nullptr && !session->energised().empty();
         });
}

Duration BusHolder::serve() {
  // A session from which `beside` was taken is a thread's own for a while (cabinet::at_all()).
  for (auto* session : sessions())
    if (!session->options().beside) return Duration::max();
  // What nodes send is heard while somebody thinks: a heartbeat that nobody took in would count as lost.
  constexpr auto kHeard = std::chrono::milliseconds(50);
  auto out = open_.empty() ? Duration::max() : Duration(kHeard);
  for (auto* session : sessions()) {
    // What goes wrong is told to the next line.
    (void)session->listen();
    if (const auto next = session->next_event(); next != kNever)
      out = std::min(out, std::max(Duration::zero(), next - session->now()));
  }
  return out;
}

Duration BusHolder::serve_beside() {
  if (open_.size() < 2 || serving_beside_) return Duration::max();
  serving_beside_ = true;
  auto out = Duration::max();
  for (auto* session : sessions()) {
    if (session == session_ || !(session->network().must_go_on() || produces_sync(*session))) continue;
    (void)session->listen();
    if (const auto next = session->next_event(); next != kNever)
      out = std::min(out, std::max(Duration::zero(), next - session->now()));
  }
  serving_beside_ = false;
  return out;
}

bool BusHolder::wait_for(pollfd& wanted, Duration longest, const std::function<void(const Error&)>& lost) {
  std::vector<pollfd> fds{wanted};
  auto left = longest;
  for (auto* session : sessions()) {
    fds.push_back({session->network().poll_fd(), POLLIN, 0});
    if (const auto next = session->next_event(); next != kNever)
      left = std::clamp<Duration>(next - session->now(), Duration::zero(), left);
  }
  if (wait_or_signal(fds, left) < 0) return false;
  for (auto* session : sessions())
    if (const auto heard = session->listen(); !heard && heard.error().code == Errc::bus) {
      lost(heard.error());
      lose(*session);
    }
  wanted.revents = fds.front().revents;
  return true;
}

void BusHolder::stop_and_disable() {
  for (auto* session : sessions()) stop_and_disable(*session);
}

void BusHolder::stop_and_disable(session::Session& session) {
  for (const auto& [node, done] : motion::de_energise(session)) {
    if (done)
      console_->err("notice: " + names(session).in(motion::disabled_notice(node)) + "\n");
    else
      warn(names(session), node, done.error().message);
  }
}

void BusHolder::warn(const show::AxisNames& names, std::uint8_t node, std::string_view why) {
  console_->err("error: " + names.in(motion::power_warning(node, why)) + "\n");
}

}  // namespace servoctl::cli
