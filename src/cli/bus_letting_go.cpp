#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/format.hpp"
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
  const auto lost = make_error(Errc::bus, message("{} was lost", as_it_is(session.url())));
  for (const auto node : session.energised().nodes()) warn(session, node, lost);
  if (produces_sync(session))
    console_->err(formatted("notice: SYNC is no longer produced: {} was lost\n", session.url()));
  drop(session, true);
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
      for (const auto node : nodes) warn(url, node, back.error());
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
      console_->note(formatted("notice: {}: trying again to stop node{} {}\n", back.error().message.text(),
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
  for (const auto& [node, done, in_fault] : motion::de_energise(session)) {
    if (in_fault)
      fail_closing(names(session), motion::ended_in_fault(node));
    else if (done)
      console_->err("notice: " + names(session).sentence(motion::disabled_notice(node)) + "\n");
    else
      warn(session, node, done.error());
  }
}

void BusHolder::warn(session::Session& session, std::uint8_t node, const Error& why) {
  warn(session::canonical_url(session.url()), node, why);
}

void BusHolder::warn(const std::string& url, std::uint8_t node, const Error& why) {
  warned_[{url, node}] = why.code;
  console_->err("error: " + names_[url].sentence(motion::power_warning(node, why.message)) + "\n");
}

void BusHolder::fail_closing(const show::AxisNames& names, const Error& error) {
  if (!closing_failure_) closing_failure_ = error.code;
  console_->err("error: " + printable(names.sentence(error.message)) + "\n");
}

bool BusHolder::has_warned_of_all() const {
  const auto warned = [this](const std::string& url, const session::EnergisedNodes& energised) {
    const auto& nodes = energised.nodes();
    return std::all_of(nodes.begin(), nodes.end(), [&](auto node) { return warned_.contains({url, node}); });
  };
  return !warned_.empty() && std::all_of(open_.begin(), open_.end(), [&](const auto& one) {
    return warned(one.first, one.second->energised());
  }) && std::all_of(left_energised_.begin(), left_energised_.end(), [&](const auto& one) {
    return warned(one.first, one.second);
  });
}

std::optional<Errc> BusHolder::failure() const {
  for (const auto& [place, why] : warned_) {
    const auto nodes = energised_on(place.first);
    if (std::find(nodes.begin(), nodes.end(), place.second) == nodes.end()) continue;
    // An end that is merely interrupted leaves nothing energised.
    return why == Errc::interrupted ? Errc::negative : why;
  }
  return closing_failure_;
}

}  // namespace servoctl::cli
