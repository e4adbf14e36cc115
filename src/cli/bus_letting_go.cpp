#include <fmt/format.h>
#include <map>
#include <set>
#include <utility>

#include "base/printable.hpp"
#include "can/descriptor.hpp"
#include "cli/bus_holder.hpp"
#include "motion/left_energised.hpp"
#include "motion/power.hpp"
#include "session/link_wait.hpp"
#include "session/open_network.hpp"

namespace servoctl::cli {
namespace {

/// Between two tries to open a bus that is lost, and two lines about it.
constexpr Duration kReconnectPause = std::chrono::milliseconds(10);
constexpr Duration kTelling = std::chrono::seconds(1);

}  // namespace

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
