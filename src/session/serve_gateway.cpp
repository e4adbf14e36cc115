#include "session/serve_gateway.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "base/signal_wait.hpp"
#include "base/timespec.hpp"

namespace servoctl::session {
namespace {

/// What moves in a simulation is looked after so often, whoever is silent.
constexpr Duration kLongestWait = std::chrono::milliseconds(250);
constexpr Duration kPatienceWithReaders = std::chrono::seconds(30);

class GatewayLoop {
 public:
  GatewayLoop(Session& session, gateway::Listener& listener, GatewayServer& server)
      : session_(&session), listener_(&listener), server_(&server) {}

  Result<void> run();

 private:
  struct Reader {
    std::size_t unread = 0;
    TimePoint since{};
  };

  Result<void> serve_network();
  void send_answers();
  void lose(int who);
  void wait();
  void take_in(const gateway::Listener::Arrival& arrival);

  Session* session_;
  gateway::Listener* listener_;
  GatewayServer* server_;
  std::map<int, Reader> readers_;  ///< All clients.
};

void GatewayLoop::lose(int who) {
  listener_->drop(who);
  readers_.erase(who);
  server_->on_lost(who);
}

/// Each arrival is handed on before the next one is taken in. A network without a descriptor is given a
/// moment, in which its clock goes on.
Result<void> GatewayLoop::serve_network() {
  const bool silent = session_->network().poll_fd() < 0;
  for (auto moment = silent ? Duration(std::chrono::milliseconds(1)) : Duration::zero();;
       moment = Duration::zero()) {
    if (const auto served = server_->serve(); !served) return served;
    const auto stepped = session_->step(session_->now() + moment);
    if (!stepped) return fail(stepped.error());
    if (!*stepped) break;
  }
  (void)session_->take_events();
  return server_->serve();
}

void GatewayLoop::send_answers() {
  std::vector<int> gone;
  for (auto& [who, reader] : readers_) {
    auto& text = server_->output(who);
    const auto before = text.size();
    const bool there = listener_->send(who, text);
    const auto now = steady_now();
    if (text.empty() || text.size() < before || reader.unread == 0) reader.since = now;
    reader.unread = text.size();
    if (!there || server_->is_done(who) || now - reader.since > kPatienceWithReaders) gone.push_back(who);
  }
  for (const int who : gone) lose(who);
}

void GatewayLoop::take_in(const gateway::Listener::Arrival& arrival) {
  if (arrival.came) {
    readers_[arrival.who] = {0, steady_now()};
    server_->on_client(arrival.who);
  }
  if (!arrival.bytes.empty()) server_->on_bytes(arrival.who, arrival.bytes);
  if (arrival.ended) server_->on_end(arrival.who);
  if (arrival.lost) lose(arrival.who);
}

void GatewayLoop::wait() {
  auto polled = listener_->interests([&](int who) {
    return static_cast<short>((server_->wants_more(who) ? POLLIN : 0) |
                              (server_->output(who).empty() ? 0 : POLLOUT));
  });
  const auto clients = polled.size();
  if (const int wire = session_->network().poll_fd(); wire >= 0) polled.push_back({wire, POLLIN, 0});
  const auto next = std::min(server_->deadline(), session_->next_event());
  const auto left = std::min(kLongestWait, left_between(session_->now(), next));
  if (servoctl::wait_or_signal(polled, left) <= 0) return;
  for (const auto& arrival : listener_->take(std::span(polled).first(clients))) take_in(arrival);
}

Result<void> GatewayLoop::run() {
  const auto& cancelled = session_->options().cancelled;
  while (!cancelled || !cancelled()) {
    const auto served = serve_network();
    if (!served && served.error().code == Errc::interrupted) return {};
    if (!served) return served;
    send_answers();
    wait();
  }
  return {};
}

}  // namespace

Result<void> serve_gateway(Session& session, gateway::Listener& listener, GatewayServer& server) {
  return GatewayLoop(session, listener, server).run();
}

}  // namespace servoctl::session
