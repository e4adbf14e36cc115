#include "cli/bus_holder.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "base/printable.hpp"
#include "base/text.hpp"
#include "can/descriptor.hpp"
#include "can/socketcan.hpp"
#include "motion/left_energised.hpp"
#include "motion/power.hpp"
#include "session/can_network.hpp"
#include "session/link_wait.hpp"
#include "session/open_network.hpp"
#include "session/serve_ring.hpp"
#include "traffic/sync_end.hpp"

namespace servoctl::cli {
namespace {

/// Between two tries to open a bus that is lost, and two lines about it.
constexpr Duration kReconnectPause = std::chrono::milliseconds(10);
constexpr Duration kTelling = std::chrono::seconds(1);

Error no_bus() {
  const auto interfaces = can::can_interfaces();
  return make_error(
      Errc::usage, "which bus?",
      interfaces.empty()
          ? "this machine has no CAN interface; try `--bus sim:FAMILY@1` (`drives` lists families), or "
            "local:NAME"
          : fmt::format("add --bus {} or set SERVOCTL_BUS", one_of(interfaces)));
}

}  // namespace

Result<session::Session*> BusHolder::open(const Settings& settings) {
  if (settings.bus.empty()) return fail(no_bus());
  if (session_ == nullptr ||
      session::canonical_url(session_->url()) != session::canonical_url(settings.bus) ||
      bus_options_.trace != settings.trace) {
    if (session_) stop_and_disable();
    stop_sync();
    drop();
    bus_options_.trace = settings.trace;
    if (auto done = connect(settings.bus); !done) return fail(done.error());
  }
  session_->options().timeout = settings.timeout;
  session_->options().retries = settings.retries;
  return session_.get();
}

Result<std::unique_ptr<session::RingEnd>> BusHolder::open_ring_end(const Settings& settings) {
  bus_options_.trace = settings.trace;
  return session::open_ring_end(settings.bus, bus_options_, options_.cancelled);
}

Result<void> BusHolder::connect(const std::string& url) {
  auto network = session::open_network(url, bus_options_);
  if (!network) return fail(network.error());
  auto session = std::make_unique<session::Session>(std::move(*network), url, options_);
  // Boot-ups of drives that are simulated in this process are no news.
  if (auto heard = session->listen(); !heard) return heard;
  (void)session->take_events();
  if (auto left = left_energised_.extract(session::canonical_url(url)))
    session->energised() = std::move(left.mapped());
  session_ = std::move(session);
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
  if (session_) session_->network().flush_trace();
  flushing_ = false;
  return std::exchange(trace_failure_, std::nullopt);
}

/// Closes the bus; what is still energised stays known.
void BusHolder::drop() {
  if (session_ && !session_->energised().empty())
    left_energised_.insert_or_assign(session::canonical_url(session_->url()),
                                     std::move(session_->energised()));
  flushing_ = true;  // What the trace could not take to the last is told by who takes its failure.
  session_.reset();
  flushing_ = false;
}

void BusHolder::lose() {
  if (!session_) return;
  for (const auto node : session_->energised().nodes()) warn(node, session_->url() + " was lost");
  if (produces_sync())
    console_->err(fmt::format("notice: SYNC is no longer produced: {} was lost\n", session_->url()));
  drop();
}

void BusHolder::let_go() {
  // Taken out only when its bus is there again: what is known to be energised stays protected.
  std::map<std::string, std::set<std::uint8_t>> left;
  for (const auto& [url, nodes] : left_energised_) left[url] = nodes.nodes();
  if (session_) stop_and_disable();
  stop_sync();
  if (!left.empty()) drop();
  for (const auto& [url, nodes] : left) {
    if (const auto back = connect_again(url, nodes); !back) {
      for (const auto node : nodes) warn(node, back.error().message);
      continue;
    }
    stop_and_disable();
    drop();
  }
}

/// A bus that is lost may come back: behind it drives are energised.
Result<void> BusHolder::connect_again(const std::string& url, const std::set<std::uint8_t>& nodes) {
  const auto end = steady_now() + session::LinkWait::kPatience;
  auto next_line = steady_now();
  for (;;) {
    auto back = connect(url);
    const auto time = steady_now();
    if (back || back.error().code != Errc::bus || time >= end) return back;
    if (time >= next_line) {
      console_->err(fmt::format("notice: {}: trying again to stop node{} {}\n", back.error().message,
                                nodes.size() == 1 ? "" : "s", fmt::join(nodes, ", ")));
      next_line += kTelling;
    }
    can::nap(kReconnectPause);
  }
}

bool BusHolder::produces_sync() const {
  return session_ && session_->can() != nullptr && session_->can()->sync() != nullptr;
}

void BusHolder::stop_sync() {
  if (!produces_sync()) return;
  const auto count = session_->can()->sync()->rhythm.count();
  for (const auto& warning : traffic::end_sync(*session_).warnings)
    console_->err("warning: " + warning + "\n");
  console_->err(fmt::format("notice: SYNC is no longer produced on {}, after {}\n", session_->url(), count));
}

bool BusHolder::must_go_on() const { return session_ && session_->network().must_go_on(); }

bool BusHolder::holds_drives() const {
  return must_go_on() || (session_ && session_->ethercat() != nullptr && !session_->energised().empty());
}

Duration BusHolder::serve() {
  if (!must_go_on() && !produces_sync()) return Duration::max();
  // What goes wrong is told to the next line.
  (void)session_->listen();
  return std::max(Duration::zero(), session_->next_event() - session_->now());
}

void BusHolder::stop_and_disable() {
  for (const auto& [node, done] : motion::de_energise(*session_)) {
    if (done)
      console_->err("notice: " + motion::disabled_notice(node) + "\n");
    else
      warn(node, done.error().message);
  }
}

void BusHolder::warn(std::uint8_t node, std::string_view why) {
  console_->err("error: " + motion::power_warning(node, why) + "\n");
}

}  // namespace servoctl::cli
