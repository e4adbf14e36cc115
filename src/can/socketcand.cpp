#include "can/socketcand.hpp"

#include <poll.h>

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/signal_wait.hpp"

namespace servoctl::can {
namespace {

using DialogueState = SocketcandDialogue::State;

constexpr Duration kConnectLimit = std::chrono::seconds(3);
constexpr Duration kReconnectLimit = std::chrono::milliseconds(500);
constexpr Duration kServerSendLimit = std::chrono::seconds(1);
/// Between two tries to reach a server that is gone.
constexpr Duration kServerPause = std::chrono::milliseconds(50);
constexpr std::size_t kMostFromServer = 1U << 20U;
constexpr std::size_t kMostComplaints = 3;

TcpServer server_at(const SocketcandPlace& place) {
  return {place.host, place.port, place.server(),
          "is the server started there, for this network and port? `socketcand -i can0 -l eth0`",
          "did its server end, or its CAN interface go down? Its own log says"};
}

bool fits_a_frame(const Frame& frame) {
  return !frame.error && frame.size <= 8 && frame.id <= (frame.extended ? 0x1FFF'FFFFU : 0x7FFU);
}

}  // namespace

tl::unexpected<Error> SocketcandBus::lose(Error error) {
  if (connection_) connection_->abandon();
  connection_.reset();
  opening_ = false;
  lost_ = error;
  return fail(std::move(error));
}

tl::unexpected<Error> SocketcandBus::not_there() const {
  return fail(lost_.value_or(make_error(Errc::bug, "a server that was not opened")));
}

/// The server has taken the connection.
Result<void> SocketcandBus::begin(TimePoint limit, bool ends_by_signal) {
  connection_.reset();
  reader_ = SocketcandReader();
  stamps_.reset();
  inbox_.clear();
  auto connection = TcpClient::connect(server_at(place_), limit, ends_by_signal);
  if (!connection) {
    lost_ = connection.error();
    return fail(connection.error());
  }
  connection_.emplace(std::move(*connection));
  dialogue_.emplace(place_.interface_name, now());
  opening_ = true;
  return {};
}

Result<void> SocketcandBus::open(TimePoint limit, bool ends_by_signal) {
  if (auto begun = begin(std::min(limit, now() + kConnectLimit), ends_by_signal); !begun) return begun;
  if (auto done = settle(limit, ends_by_signal); !done) return lose(done.error());
  return {};
}

Result<void> SocketcandBus::settle(TimePoint limit, bool ends_by_signal) {
  while (!dialogue_->is_settled() && now() < limit) {
    if (const auto spoken = speak(); !spoken) return spoken;
    const auto end = std::min(dialogue_->deadline(), limit);
    const auto woken = ends_by_signal ? wait_or_signal(connection_->get(), POLLIN, end)
                                      : wait_for(connection_->get(), POLLIN, end);
    if (woken == Wake::interrupted && ends_by_signal) return fail(Errc::interrupted, "interrupted");
    if (woken == Wake::ready)
      // A server that refuses closes the connection behind its word.
      if (const auto filled = fill(); !filled && dialogue_->state() != DialogueState::refused) return filled;
    dialogue_->on_time(now());
  }
  if (auto done = judge(); !done) return done;
  opening_ = false;
  lost_.reset();
  return {};
}

Result<void> SocketcandBus::judge() const {
  const auto server = place_.server();
  switch (dialogue_->state()) {
    case DialogueState::raw: return {};
    case DialogueState::refused:
      return fail(
          Errc::bus,
          message("{} refuses {}: {}", as_it_is(server), as_it_is(place_.interface_name), dialogue_->why()),
          "it has the interfaces that it was started with (its option -i), and they have to be up there");
    case DialogueState::stranger:
      return fail(
          Errc::bus, message("what listens at {} is no socketcand", as_it_is(server)),
          message("its port is {}, where it was not started with another one", SocketcandPlace::kPort));
    case DialogueState::silent:
    case DialogueState::greeted:
    case DialogueState::opening:
    case DialogueState::entering_raw_mode:
    case DialogueState::testing_echo: break;
  }
  return fail(Errc::bus, message("{} took the connection and does not answer", as_it_is(server)),
              "is it a socketcand, and does it hang?");
}

Result<void> SocketcandBus::speak() {
  const auto text = dialogue_->take_text();
  if (text.empty()) return {};
  if (!connection_) return not_there();
  if (auto sent = connection_->send(text, now() + kServerSendLimit); !sent) return lose(sent.error());
  return {};
}

Result<void> SocketcandBus::fill() {
  std::string bytes;
  const auto got = connection_->receive(bytes);
  const auto time = now();
  if (!bytes.empty()) dialogue_->on_life(time);
  reader_.put(bytes);
  while (const auto element = reader_.take()) on_element(*element, time);
  if (!got) return lose(got.error());
  return {};
}

void SocketcandBus::on_element(const SocketcandElement& element, TimePoint time) {
  const bool is_raw = dialogue_->is_settled();
  dialogue_->on_element(element, time);
  switch (element.kind) {
    case SocketcandElement::Kind::frame:
      if (inbox_.size() < kMostFromServer)
        inbox_.push_back({element.frame, stamps_.time(element.time, time)});
      return;
    case SocketcandElement::Kind::damaged: damaged_ += is_raw ? 1 : 0; return;
    case SocketcandElement::Kind::refusal:
      if (is_raw && complaints_.size() < kMostComplaints) complaints_.push_back(element.text);
      return;
    default: return;
  }
}

/// Room comes with the answers to echoes; frames that arrive meanwhile are kept.
Result<void> SocketcandBus::await_room(std::size_t size, TimePoint limit) {
  while (!dialogue_->has_room(size)) {
    if (const auto spoken = speak(); !spoken) return spoken;
    if (now() >= limit)
      return fail(Errc::bus, message("{} takes no frames any more", as_it_is(place_.server())),
                  "is its machine or the network between overloaded?");
    if (wait_for(connection_->get(), POLLIN, limit) != Wake::ready) continue;
    if (const auto filled = fill(); !filled) return filled;
  }
  return {};
}

Result<void> SocketcandBus::send(const Frame& frame) {
  if (!fits_a_frame(frame))
    return fail(Errc::bug,
                message("a frame that cannot be sent: {}, {} bytes", to_string(frame), frame.size));
  if (frame.remote)
    return fail(
        Errc::usage,
        message("the remote frame {} cannot be sent by socketcand: its protocol has none", to_string(frame)),
        "node guarding and PDOs that are asked for need another bus; heartbeat (1017h) goes without");
  if (!is_open()) return not_there();
  const auto text = socketcand_send(frame);
  const auto limit = now() + kServerSendLimit;
  if (const auto room = await_room(text.size(), limit); !room) return room;
  // In one piece: the server ends the connection when it finds half an element.
  if (auto sent = connection_->send(text, limit); !sent) return lose(sent.error());
  dialogue_->on_sent(text.size(), now());
  return speak();
}

Result<std::optional<Frame>> SocketcandBus::receive(TimePoint deadline) {
  for (;;) {
    if (!inbox_.empty()) {
      const auto [frame, time] = inbox_.front();
      inbox_.pop_front();
      arrived_ = time;
      return std::optional(frame);
    }
    if (!is_open()) return not_there();
    const auto woken = wait_or_signal(connection_->get(), POLLIN,
                                      std::min(deadline, std::max(now(), dialogue_->deadline())));
    if (woken == Wake::interrupted) return std::optional<Frame>();
    if (woken == Wake::ready) {
      // What came before the loss is given first.
      if (const auto filled = fill(); !filled && inbox_.empty()) return fail(filled.error());
      if (inbox_.empty() && now() >= deadline) return std::optional<Frame>();
      continue;
    }
    dialogue_->on_time(now());
    if (dialogue_->state() != DialogueState::raw)
      return lose(make_error(Errc::bus, message("{} does not answer any more", as_it_is(place_.server())),
                             "check cable and network, and whether its server hangs"));
    if (const auto spoken = speak(); !spoken) return fail(spoken.error());
    if (now() >= deadline) return std::optional<Frame>();
  }
}

Result<void> SocketcandBus::recover(TimePoint deadline) {
  for (;;) {
    auto opened = opening_ ? Result<void>() : begin(std::max(deadline, now() + kReconnectLimit), false);
    if (opened) opened = settle(deadline, false);
    if (opened || (opening_ && !dialogue_->is_settled())) return opened;
    (void)lose(opened.error());
    if (now() >= deadline) return opened;
    nap(std::min<Duration>(kServerPause, deadline - now()));
  }
}

std::vector<Message> SocketcandBus::take_notices() {
  std::vector<Message> out;
  for (const auto& text : std::exchange(complaints_, {}))
    out.push_back(message("{} reports an error: {}", as_it_is(place_.server()), as_it_is(text)));
  if (const auto count = std::exchange(damaged_, 0); count > 0)
    out.push_back(message("{}: {} element{} left out: no frame of the protocol", as_it_is(place_.server()),
                          count, ending(count, " was", "s were")));
  return out;
}

TimePoint SocketcandBus::next_event() const {
  if (!inbox_.empty()) return TimePoint::min();
  return is_open() ? dialogue_->deadline() : kNever;
}

Result<std::unique_ptr<Bus>> open_socketcand(std::string_view place) {
  auto parsed = parse_socketcand_place(place);
  if (!parsed) return fail(parsed.error());
  auto bus = std::make_unique<SocketcandBus>(std::move(*parsed));
  if (const auto opened = bus->open(kNever, true); !opened) return fail(opened.error());
  return bus;
}

}  // namespace servoctl::can
