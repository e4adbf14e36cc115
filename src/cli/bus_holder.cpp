#include "cli/bus_holder.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "can/socketcan.hpp"
#include "cli/restriction.hpp"
#include "session/can_network.hpp"
#include "session/open_network.hpp"
#include "session/open_port.hpp"
#include "session/serve_registers.hpp"
#include "session/serve_ring.hpp"
#include "traffic/sync_end.hpp"

namespace servoctl::cli {
namespace {

/// The port that a URL names, without what is said of it: `slcan:/dev/ttyACM0` of `slcan:/dev/ttyACM0@1M`.
std::string_view port_of(std::string_view url) { return url.substr(0, url.find_first_of("@?")); }

/// Adapters and hosts are asked, and waited for; an interface of the kernel is there or not.
bool opens_at_once(const std::string& url) {
  return url.find(':') == std::string::npos || url.starts_with("sim:") || url.starts_with("local:");
}

/// Whether the bus is that of a serial adapter: `slcan:/dev/ttyACM0@500k` of `slcan:/dev/ttyACM0`.
bool is_over(std::string_view url, std::string_view adapter) {
  return adapter.starts_with("slcan:") && url.starts_with(adapter) &&
         url.substr(adapter.size()).starts_with('@');
}

/// What the bus is, and at which bitrate where that is known here.
std::string kind_text(session::Session& session) {
  if (session.ethercat() != nullptr) return "CANopen over EtherCAT";
  if (session.modbus() != nullptr) return "Modbus";
  if (session.gateway() != nullptr) return "a gateway of CiA 309-3";
  const auto bitrate = session::bitrate_of(session.url());
  if (!bitrate) return "CAN";
  return session::link_of(session.url()) ? formatted("CAN, {} bit/s by the kernel", *bitrate)
                                         : formatted("CAN, {} bit/s by its URL", *bitrate);
}

}  // namespace

Result<session::Session*> BusHolder::open(const Settings& settings) {
  if (settings.bus.empty())
    return fail(Errc::usage, "which bus?", bus_hint(can::can_interfaces(), session::ethercat_links()));
  if (const auto* restriction = Restriction::current())
    if (const auto allowed = restriction->check_bus(settings.bus); !allowed) return fail(allowed.error());
  const auto url = session::canonical_url(settings.bus);
  const bool traces_anew = bus_options_.trace != settings.trace;
  const bool is_open = open_.count(url) > 0 && !traces_anew;
  // A bus that cannot be opened leaves all as it is: a word that was mistyped ends no SYNC. But nobody serves
  // the others while one is waited for: where that matters they are let go first.
  const bool has_time = opens_at_once(url) || !(sends_regularly() || holds_drives());
  const bool beside =
      !is_open && settings.trace.empty() && !traces_anew && !holds_port(settings.bus) && has_time;
  if (beside)
    if (const auto done = connect(settings.bus); !done) return fail(done.error());
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
  if (!is_open && console_->is_verbose()) tell_opened();
  return session_;
}

bool BusHolder::holds_port(std::string_view url) const {
  return std::any_of(open_.begin(), open_.end(),
                     [&](const auto& one) { return port_of(one.second->url()) == port_of(url); });
}

std::vector<std::uint8_t> BusHolder::energised_on(std::string_view url) const {
  const auto wanted = session::canonical_url(url);
  std::vector<std::uint8_t> out;
  const auto add = [&](const std::string& key, const session::EnergisedNodes& energised) {
    if (key == wanted || is_over(key, wanted))
      out.insert(out.end(), energised.nodes().begin(), energised.nodes().end());
  };
  for (const auto& [key, session] : open_) add(key, session->energised());
  for (const auto& [key, energised] : left_energised_) add(key, energised);
  return out;
}

bool BusHolder::has_adapter(std::string_view adapter) const {
  return std::any_of(open_.begin(), open_.end(),
                     [&](const auto& bus) { return is_over(bus.first, adapter); });
}

Result<void> BusHolder::release_adapter(std::string_view adapter) {
  if (const auto nodes = energised_on(adapter); !nodes.empty())
    return fail(Errc::refused,
                message("{} stays open: node {} is energised over it", adapter, node_name(nodes.front())),
                message("`disable -n {}` first", node_name(nodes.front())));
  for (auto* session : sessions()) {
    if (!is_over(session::canonical_url(session->url()), adapter)) continue;
    stop_sync(*session);
    drop(*session);
  }
  return {};
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

HeardStates::State BusHolder::heard_state(const session::Session& session, std::uint8_t node,
                                          const HeardStates::Family& family) const {
  const auto found = opened_.find(&session);
  return found == opened_.end() ? HeardStates::State() : found->second.heard->state(node, family);
}

RestartWatch* BusHolder::restarts(const session::Session& session) const {
  const auto found = opened_.find(&session);
  return found == opened_.end() ? nullptr : found->second.restarts.get();
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
  auto heard = std::make_unique<HeardStates>(*session_);
  opened_[session_] = {std::move(heard), std::make_unique<RestartWatch>(*session_, state_folder_),
                       ++openings_};
  open_[session::canonical_url(url)] = std::move(session);
  return {};
}

/// How the bus was opened.
void BusHolder::tell_opened() {
  const auto& url = session_->url();
  const auto& options = session_->options();
  console_->detail(formatted("bus {} is open ({}); longest wait for an answer: {} ms, retries of a read: {}",
                             url, kind_text(*session_),
                             std::chrono::duration_cast<std::chrono::milliseconds>(options.timeout).count(),
                             options.retries));
  if (!bus_options_.trace.empty())
    console_->detail(formatted("every frame is written to {}", bus_options_.trace.string()));
}

/// What breaks while a line runs is told at once: a recording may go on for hours.
void BusHolder::on_trace_failed(const Error& error) {
  trace_failure_ = error;
  if (!flushing_)
    console_->err(
        formatted("notice: {}; {}\n", printable(error.message.text()), printable(error.hint.text())));
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

void BusHolder::drop(session::Session& session, bool is_lost) {
  const auto url = session::canonical_url(session.url());
  flushing_ = true;  // What the trace could not take to the last is told by who takes its failure.
  const auto closed = session.close();
  flushing_ = false;
  if (!closed && !is_lost) fail_closing(names(session), closed.error());
  if (!session.energised().empty()) left_energised_.insert_or_assign(url, std::move(session.energised()));
  opened_.erase(&session);
  open_.erase(url);
  session_ = open_.empty() ? nullptr : open_.begin()->second.get();
}

bool BusHolder::produces_sync() const {
  const auto all = sessions();
  return std::any_of(all.begin(), all.end(), [](auto* session) { return produces_sync(*session); });
}

bool BusHolder::produces_sync(session::Session& session) {
  return session.can() != nullptr && session.can()->sync() != nullptr;
}

bool BusHolder::sends_regularly() const {
  return std::any_of(open_.begin(), open_.end(), [](const auto& one) {
    auto* can = one.second->can();
    const bool beats = can != nullptr && can->heartbeat_node();
    return beats || produces_sync(*one.second) || one.second->network().must_go_on();
  });
}

void BusHolder::stop_sync() {
  for (auto* session : sessions()) stop_sync(*session);
}

void BusHolder::stop_sync(session::Session& session) {
  if (!produces_sync(session)) return;
  const auto count = session.can()->sync()->rhythm.count();
  for (const auto& warning : traffic::end_sync(session).warnings) console_->err("warning: " + warning + "\n");
  console_->note(formatted("notice: SYNC is no longer produced on {}, after {}\n", session.url(), count));
}

bool BusHolder::must_go_on() const {
  const auto all = sessions();
  return std::any_of(all.begin(), all.end(), [](auto* session) { return session->network().must_go_on(); });
}

bool BusHolder::leaves_power() const {
  const auto all = sessions();
  return std::any_of(all.begin(), all.end(), [](auto* session) { return !session->energised().empty(); });
}

bool BusHolder::holds_drives() const {
  const auto all = sessions();
  return must_go_on() || std::any_of(all.begin(), all.end(), [](auto* session) {
           return session->ethercat() != nullptr && !session->energised().empty();
         });
}

}  // namespace servoctl::cli
