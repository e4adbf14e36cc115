#include "session/gateway_network.hpp"

#include <poll.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/signal_wait.hpp"
#include "session/gateway_object_channel.hpp"

namespace servoctl::session {
namespace {

constexpr std::string_view kGatewayScheme = "gateway:";
constexpr Duration kConnectPatience = std::chrono::seconds(3);
/// For an answer that needs no node.
constexpr Duration kAnswerPatience = std::chrono::seconds(3);
constexpr Duration kReconnectPause = std::chrono::milliseconds(100);

/// Objects are read when somebody asks; nothing comes by itself.
class NothingTold final : public ProcessValues {
 public:
  std::optional<Bytes> take(ObjectAddress, TimePoint) override { return std::nullopt; }
  bool carries(ObjectAddress) const override { return false; }
  void keep_all() override {}
  std::vector<Arrival> take_all() override { return {}; }
};

/// The gateway's answer where a command needs a network, and none was set (CiA 309-3).
constexpr std::uint32_t kNoDefaultNet = 104;

std::string_view word_of(canopen::NmtCommand command) {
  switch (command) {
    case canopen::NmtCommand::start: return "start";
    case canopen::NmtCommand::stop: return "stop";
    case canopen::NmtCommand::enter_pre_operational: return "preop";
    case canopen::NmtCommand::reset_node: return "reset node";
    case canopen::NmtCommand::reset_communication: return "reset comm";
  }
  return {};
}

}  // namespace

bool is_gateway(std::string_view url) { return url.starts_with(kGatewayScheme); }

Result<std::unique_ptr<GatewayNetwork>> GatewayNetwork::open(const std::string& url,
                                                             const BusOptions& options) {
  if (!options.trace.empty())
    return fail(Errc::usage, "--trace records frames of CAN and EtherCAT; there is no trace of a gateway",
                "leave --trace out");
  auto address = gateway::parse_url(std::string_view(url).substr(kGatewayScheme.size()));
  if (!address) return fail(address.error());
  auto connection = gateway::Connection::open(*address, steady_now() + kConnectPatience, true);
  if (!connection) return fail(connection.error());
  auto out = std::make_unique<GatewayNetwork>(std::move(*connection), std::move(*address), url);
  if (const auto known = out->introduce(); !known) return fail(known.error());
  return out;
}

GatewayNetwork::~GatewayNetwork() = default;

std::string GatewayNetwork::timeout_line() const {
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(timeout_).count();
  const auto line = formatted("set sdo_timeout {}", std::clamp<std::int64_t>(ms, 1, 65'535));
  return names_network_ ? formatted("{} {}", address_.network, line) : line;
}

/// What answers this is a gateway, whatever the answer. CANopenNode has the timeout for all networks and
/// knows no network in front of it, lely-core one for each.
Result<void> GatewayNetwork::introduce() {
  timeout_ = std::chrono::milliseconds(500);
  names_network_ = false;
  auto answer = ask(timeout_line(), kAnswerPatience);
  if (answer && answer->kind == gateway::Answer::Kind::error && answer->number == kNoDefaultNet) {
    names_network_ = true;
    answer = ask(timeout_line(), kAnswerPatience);
  }
  if (!answer && answer.error().code == Errc::timeout)
    return fail(Errc::bus, message("{} does not answer as a gateway of CiA 309-3", as_it_is(url_)),
                "does it serve another client? canopend serves one at a time");
  if (!answer) return fail(answer.error());
  takes_timeout_ = answer->kind == gateway::Answer::Kind::ok;
  return {};
}

std::unique_ptr<ObjectChannel> GatewayNetwork::object_channel(std::uint8_t node, Duration timeout) {
  return std::make_unique<GatewayObjectChannel>(*this, node, timeout);
}

/// An answer that still comes has a number that nobody waits for.
void GatewayNetwork::leave(GatewayObjectChannel& channel) {
  std::erase(waiting_, &channel);
  if (asking_ != &channel) return;
  asking_ = nullptr;
  client_.abandon();
}

TimePoint GatewayNetwork::next_event() const {
  if (client_.busy()) return client_.deadline();
  return waiting_.empty() ? kNever : now();
}

void GatewayNetwork::begin_anew() {
  if (asking_ != nullptr) asking_->forget();
  for (auto* channel : waiting_) channel->forget();
  asking_ = nullptr;
  waiting_.clear();
  setting_timeout_ = false;
  client_.reset();
}

Error GatewayNetwork::gone() const {
  return make_error(Errc::bus, message("the connection to {} is lost", as_it_is(url_)),
                    "the next line connects anew");
}

Error GatewayNetwork::silent() const {
  return make_error(
      Errc::bus, message("{} does not answer any more", as_it_is(url_)),
      "check cable and network, and whether it hangs or serves another client (canopend serves one at a "
      "time); the next line connects anew");
}

/// Whoever asked is told by who steps: the connection is lost for all of them.
Result<void> GatewayNetwork::lose(Error error) {
  begin_anew();
  connection_.reset();
  return fail(std::move(error));
}

Result<void> GatewayNetwork::start(std::string_view request, Duration patience) {
  if (!connection_) return fail(gone());
  const auto line = client_.start(request, now(), patience);
  if (auto sent = connection_->send(line, now() + kAnswerPatience); !sent) return lose(sent.error());
  return {};
}

Result<void> GatewayNetwork::pump() {
  if (!connection_ || client_.busy() || waiting_.empty()) return {};
  auto* next = waiting_.front();
  if (takes_timeout_ && next->timeout() != timeout_) {
    timeout_ = next->timeout();
    setting_timeout_ = true;
    return start(timeout_line(), kAnswerPatience);
  }
  waiting_.pop_front();
  asking_ = next;
  return start(next->request(), next->patience());
}

void GatewayNetwork::hand_over(const gateway::Client::Outcome& outcome) {
  if (std::exchange(setting_timeout_, false)) return;
  if (asking_ != nullptr)
    std::exchange(asking_, nullptr)->on_outcome(outcome);
  else if (!outcome.silent)
    own_ = outcome.answer;
}

Result<bool> GatewayNetwork::step(TimePoint deadline) {
  if (!connection_) return fail(gone());
  if (const auto sent = pump(); !sent) return fail(sent.error());
  const auto woken = can::wait_or_signal(poll_fd(), POLLIN, std::min(deadline, next_event()));
  std::string bytes;
  auto received = woken == can::Wake::ready && connection_ ? connection_->receive(bytes) : Result<void>();
  stepped_at_ = now();
  client_.on_bytes(bytes, stepped_at_);
  client_.on_time(stepped_at_);
  const auto outcome = client_.take_outcome();
  // It has told of every node that does not answer: one that tells nothing is away, for all who ask.
  if (outcome && outcome->silent && asking_ != nullptr) return fail(lose(silent()).error());
  if (outcome) hand_over(*outcome);
  if (!received && !outcome) return fail(lose(received.error()).error());
  if (client_.is_broken())
    return fail(lose(make_error(Errc::bus, message("{}: what came is no answer of CiA 309-3", as_it_is(url_)),
                                "is another service at this port?"))
                    .error());
  return outcome || !bytes.empty();
}

Result<gateway::Answer> GatewayNetwork::ask(std::string_view request, Duration patience) {
  // What others asked comes to its end first.
  while (client_.busy())
    if (const auto stepped = step(client_.deadline()); !stepped) return fail(stepped.error());
  own_.reset();
  if (const auto sent = start(request, patience); !sent) return fail(sent.error());
  const auto signals = signals_noted();
  while (client_.busy()) {
    const bool is_cancelled = cancelled_ ? cancelled_() : signals_noted() != signals;
    if (is_cancelled) return fail(Errc::interrupted, "interrupted");
    if (const auto stepped = step(client_.deadline()); !stepped) return fail(stepped.error());
  }
  if (!own_) return fail(Errc::timeout, message("{} does not answer", as_it_is(url_)));
  return *std::exchange(own_, std::nullopt);
}

Result<void> GatewayNetwork::recover(TimePoint deadline) {
  begin_anew();
  connection_.reset();
  for (;;) {
    auto again = gateway::Connection::open(address_, std::max(deadline, now() + kReconnectPause), true);
    if (again) {
      connection_ = std::move(*again);
      return introduce();
    }
    if (again.error().code == Errc::interrupted || now() >= deadline) return fail(again.error());
    if (can::wait_or_signal(-1, 0, std::min(deadline, now() + kReconnectPause)) == can::Wake::interrupted)
      return fail(again.error());
  }
}

std::string GatewayNetwork::command_line(std::uint8_t node, canopen::NmtCommand command) const {
  return formatted("{} {} {}", address_.network, node, word_of(command));
}

Result<void> GatewayNetwork::command(std::uint8_t node, canopen::NmtCommand command) {
  const auto line = command_line(node, command);
  const auto answer = ask(line, kAnswerPatience);
  if (!answer) return fail(answer.error());
  if (answer->kind == gateway::Answer::Kind::ok) {
    if (ordered_) ordered_(node, formatted("NMT \"{}\"", canopen::name(command)));
    return {};
  }
  return fail(Errc::refused,
              message("the gateway answers '{}' to '{}': {} {}", as_it_is(answer->number), as_it_is(line),
                      gateway::code_text(answer->number), as_it_is(printable(answer->text))),
              "one of servoctl only reads unless it was started with --allow write");
}

Result<void> GatewayNetwork::request_state(std::uint8_t node, NodeState state) {
  switch (state) {
    case NodeState::operational: return command(node, canopen::NmtCommand::start);
    case NodeState::pre_operational: return command(node, canopen::NmtCommand::enter_pre_operational);
    case NodeState::stopped: return command(node, canopen::NmtCommand::stop);
    default: return fail(drive_error(Errc::usage, node, "no NMT command leads to this state"));
  }
}

Result<void> GatewayNetwork::arm_watchdog(std::uint8_t node, const LifeSign&) {
  return fail(drive_error(Errc::usage, node, "over a gateway there are no signs of life"));
}

void GatewayNetwork::send_last_word(std::uint8_t node, ObjectAddress object, std::uint16_t value) noexcept {
  if (!connection_) return;
  // A number that no request has reached: its answer is nobody's.
  std::array<char, 64> line{};
  const auto end = fmt::format_to_n(line.begin(), line.size(), "[4294967295] {} {} w 0x{:04X} {} u16 {}\r\n",
                                    address_.network, node, object.index, object.sub, value);
  connection_->send_now({line.data(), std::min(end.size, line.size())});
}

std::unique_ptr<ProcessValues> GatewayNetwork::process_values(std::uint8_t, std::span<const ObjectAddress>) {
  return std::make_unique<NothingTold>();
}

std::string_view GatewayNetwork::why_no_power() const {
  return "a gateway passes on no sign of life, and when the connection to it is lost nobody stops the motor";
}

std::string GatewayNetwork::silence_hint(std::uint8_t node) const {
  return formatted(
      "is node {} on the bus of the gateway, and its network number {}? Check power, cable and bitrate there",
      node, address_.network);
}

}  // namespace servoctl::session
