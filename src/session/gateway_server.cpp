#include "session/gateway_server.hpp"

#include <algorithm>
#include <vector>

#include "base/format.hpp"
#include "drive/enabling_write.hpp"
#include "session/answer.hpp"
#include "session/wary.hpp"

namespace servoctl::session {
namespace {

/// Lines of one client that are looked at before the network and the others have their turn.
constexpr int kLinesAtOnce = 16;

}  // namespace

void GatewayServer::on_bytes(int who, std::string_view bytes) { clients_[who].in.put(bytes); }

void GatewayServer::on_end(int who) {
  auto& client = clients_[who];
  client.ended = true;
  // A last line may have no end.
  client.is_cut = client.in.pending() > 0;
  if (client.is_cut) client.in.put("\n");
}

void GatewayServer::on_lost(int who) {
  const auto client = clients_.find(who);
  if (client == clients_.end()) return;
  if (client->second.refused > 1)
    tell(formatted("a client went; {} of its requests were refused", client->second.refused));
  clients_.erase(client);
}

bool GatewayServer::may_take_lines(const Client& client) const {
  return !client.order && client.out.size() < kMostOutput && client.in.has_line();
}

bool GatewayServer::wants_more(int who) const {
  const auto client = clients_.find(who);
  return client != clients_.end() && !client->second.ended && !client->second.in.has_line();
}

bool GatewayServer::is_done(int who) const {
  const auto client = clients_.find(who);
  if (client == clients_.end()) return true;
  const auto& it = client->second;
  return it.ended && !it.order && it.out.empty() && !it.in.has_line();
}

bool GatewayServer::may_go(int who) const {
  const auto client = clients_.find(who);
  if (client == clients_.end()) return true;
  const bool enabled = std::any_of(energised_.begin(), energised_.end(),
                                   [&](const auto& drive) { return drive.second == who; });
  return !enabled && !client->second.order && client->second.out.empty() && !client->second.in.has_line();
}

std::set<std::uint8_t> GatewayServer::energised() const {
  std::set<std::uint8_t> out;
  for (const auto& [node, who] : energised_) out.insert(node);
  return out;
}

TimePoint GatewayServer::deadline() const {
  auto out = kNever;
  for (const auto& [node, lane] : lanes_) out = std::min(out, lane.channel->deadline());
  for (const auto& [who, client] : clients_)
    if (may_take_lines(client)) return session_->now();
  return out;
}

Result<void> GatewayServer::serve() {
  for (auto& [who, client] : clients_) take_lines(client);
  start_orders();
  for (auto lane = lanes_.begin(); lane != lanes_.end();) {
    if (const auto served = serve_lane(lane->first, lane->second); !served) return served;
    lane = lane->second.channel ? std::next(lane) : lanes_.erase(lane);
  }
  return stop_abandoned() ? serve() : Result<void>();
}

void GatewayServer::take_lines(Client& client) {
  for (int lines = 0; lines < kLinesAtOnce && may_take_lines(client); ++lines)
    if (const auto line = client.in.take()) handle(client, *line);
}

/// Whoever had its turn last waits for those who come behind it.
void GatewayServer::start_orders() {
  std::vector<int> order;
  for (const auto& [who, client] : clients_)
    if (client.order && !client.order->started) order.push_back(who);
  std::rotate(order.begin(), std::upper_bound(order.begin(), order.end(), served_last_), order.end());
  for (const int who : order) start(who, clients_[who]);
}

void GatewayServer::start(int who, Client& client) {
  const auto node = client.order->request.node;
  if (lanes_.count(node) != 0) return;
  auto& lane = lanes_[node] = {session_->lend_channel(node), who, session_->now()};
  lane.channel->set_timeout(client.timeout);
  client.order->started = true;
  served_last_ = who;
  // A controlword may be a stop.
  const bool decided = client.order->request.object == objects::kControlword ||
                       session_->is_considered(node) || !session_->options().drive_folders ||
                       session_->modbus() != nullptr;
  if (!decided) {
    lane.numbers.emplace().node = node;
    return ask_number(lane);
  }
  if (!begin(lane, *client.order)) lanes_.erase(node);
}

void GatewayServer::ask_number(Lane& lane) {
  lane.channel->start_upload(kDecidingNumbers[lane.numbers_read], session_->now(),
                             canopen::Transfer::automatic, 0);
}

/// False where the node did not answer: its client is told so, and nothing else is asked.
bool GatewayServer::take_number(Lane& lane, const Result<Bytes>& result) {
  if (!result && result.error().code == Errc::timeout) return false;
  auto& numbers = *lane.numbers;
  std::optional<std::uint32_t>* const places[] = {&numbers.device_type, &numbers.vendor_id,
                                                  &numbers.product_code};
  *places[lane.numbers_read] = u32_in(result);
  if (++lane.numbers_read < kDecidingNumbers.size()) {
    ask_number(lane);
    return true;
  }
  consider_numbers(*session_, numbers);
  lane.numbers.reset();
  return true;
}

/// Sends the request of the client. False where it is answered without the drive.
bool GatewayServer::begin(Lane& lane, Client::Order& order) {
  const auto& request = order.request;
  const auto who = lane.who;
  if (const auto refusal = refusal_of(*session_, request.node, request.object)) {
    session_->give_back(request.node, std::move(lane.channel));
    finish(lane, fail(*refusal));
    return false;
  }
  if (request.data) {
    // Noted before it is sent: from then on no signal ends the process before the drive is let go.
    if (drive::is_enabling_write(request.object, *request.data) ||
        (options_.energises && options_.energises(request.node, request.object, *request.data))) {
      session_->energised().insert(request.node);
      energised_[request.node] = who;
    }
    lane.channel->start_download(request.object, *request.data, session_->now(), request.transfer);
  } else {
    lane.channel->start_upload(request.object, session_->now(), request.transfer, 0);
  }
  lane.begun = session_->now();
  return true;
}

Result<void> GatewayServer::serve_lane(std::uint8_t node, Lane& lane) {
  while (lane.channel) {
    if (const auto sent = lane.channel->on_time(session_->now()); !sent) return sent;
    const auto result = lane.channel->take_result();
    if (!result) return {};
    // Another drive may come in its place.
    if (!*result && result->error().code == Errc::timeout) session_->doubt_numbers(node);
    const auto client = clients_.find(lane.who);
    if (lane.numbers && client != clients_.end() && client->second.order && take_number(lane, *result)) {
      if (!lane.numbers) begin(lane, *client->second.order);
      continue;
    }
    session_->give_back(node, std::move(lane.channel));
    lane.channel.reset();
    if (!lane.numbers) tell(node, lane, *result);
    finish(lane, *result);
  }
  return {};
}

void GatewayServer::tell(std::uint8_t node, const Lane& lane, const Result<Bytes>& result) const {
  const auto& exchanged = session_->options().exchanged;
  const auto client = clients_.find(lane.who);
  if (!exchanged || client == clients_.end() || !client->second.order) return;
  const auto& request = client->second.order->request;
  exchanged({*session_, node, request.object, request.data ? &*request.data : nullptr, result, lane.begun,
             session_->now()});
}

void GatewayServer::finish(const Lane& lane, const Result<Bytes>& result) {
  const auto client = clients_.find(lane.who);
  if (client == clients_.end() || !client->second.order) return;
  const auto& order = *client->second.order;
  auto& out = client->second.out;
  if (!result)
    out += gateway::failure_line(order.sequence, result.error());
  else if (order.request.data)
    out += gateway::ok_line(order.sequence);
  else
    out += gateway::value_line(order.sequence, gateway::value_text(order.type, *result));
  client->second.order.reset();
}

/// What another client has under way with a drive that is to be stopped is cut: its power comes first. A read
/// is begun anew behind it.
void GatewayServer::cut(std::uint8_t node) {
  const auto found = lanes_.find(node);
  if (found == lanes_.end()) return;
  auto lane = std::move(found->second);
  lanes_.erase(found);
  lane.channel.reset();
  const auto client = clients_.find(lane.who);
  if (client == clients_.end() || !client->second.order) return;
  if (client->second.order->request.data)
    finish(lane, fail(Errc::interrupted, "the client that enabled the drive went, and it is being stopped"));
  else
    client->second.order->started = false;
}

bool GatewayServer::stop_abandoned() {
  std::set<std::uint8_t> nodes;
  for (const auto& [node, who] : energised_)
    if (clients_.count(who) == 0) nodes.insert(node);
  if (nodes.empty()) return false;
  for (const auto node : nodes) {
    energised_.erase(node);
    cut(node);
  }
  if (options_.stop) options_.stop(nodes);
  return true;
}

}  // namespace servoctl::session
