#include "session/modbus_network.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "drive/standard_objects.hpp"
#include "session/modbus_object_channel.hpp"

namespace servoctl::session {
namespace {

/// Registers are read when somebody asks; nothing comes by itself.
class NoValues final : public ProcessValues {
 public:
  std::optional<Bytes> take(ObjectAddress, TimePoint) override { return std::nullopt; }
  bool carries(ObjectAddress) const override { return false; }
  void keep_all() override {}
  std::vector<Arrival> take_all() override { return {}; }
};

}  // namespace

ModbusNetwork::ModbusNetwork(std::unique_ptr<modbus::Port> port, std::string url)
    : port_(std::move(port)), url_(std::move(url)), client_(port_->framing()) {
  client_.set_silence(port_->silence());
  stepped_at_ = port_->now();
}

ModbusNetwork::~ModbusNetwork() = default;

std::unique_ptr<ObjectChannel> ModbusNetwork::object_channel(std::uint8_t node, Duration timeout) {
  return request_channel(node, timeout);
}

std::unique_ptr<ModbusObjectChannel> ModbusNetwork::request_channel(std::uint8_t node, Duration timeout) {
  return std::make_unique<ModbusObjectChannel>(*this, node, timeout);
}

void ModbusNetwork::learn(std::uint8_t node, const drive::ModbusRules& rules) {
  rules_.insert_or_assign(node, rules);
  client_.set_silence(std::max<Duration>(client_.silence(), std::chrono::milliseconds(rules.silence_ms)));
}

std::optional<std::uint16_t> ModbusNetwork::register_of(std::uint8_t node, ObjectAddress object) const {
  const auto found = rules_.find(node);
  return found == rules_.end() ? std::nullopt : found->second.register_of(object);
}

std::uint16_t ModbusNetwork::presence_register(std::uint8_t node) const {
  const auto found = rules_.find(node);
  return found == rules_.end() || !found->second.exists() ? 0 : found->second.registers.front().at;
}

void ModbusNetwork::leave(ModbusObjectChannel& channel) {
  std::erase(waiting_, &channel);
  if (asking_ != &channel) return;
  client_.abandon();
  asking_ = nullptr;
}

TimePoint ModbusNetwork::next_event() const {
  if (client_.busy()) return client_.deadline();
  auto out = kNever;
  for (const auto* channel : waiting_) out = std::min(out, free_at(*channel));
  return out;
}

TimePoint ModbusNetwork::free_at(const ModbusObjectChannel& channel) const {
  return std::max(client_.free_at(channel.node()), channel.not_before());
}

/// What answers a request that was given up answers a further try of it as well.
bool ModbusNetwork::hand_over_late() {
  for (auto* channel : waiting_) {
    auto late = channel->is_again() ? client_.take_late(channel->node(), channel->pdu()) : std::nullopt;
    if (!late) continue;
    std::erase(waiting_, channel);
    channel->on_outcome(*late);
    return true;
  }
  return false;
}

/// Two registers: the answer is longer than that to a request for one.
Bytes ModbusNetwork::check_for(const ModbusObjectChannel& channel) const {
  const auto& pdu = channel.pdu();
  const bool asks_for_two = pdu.size() == 5 && modbus::load_be16(ByteSpan(pdu).subspan(3)) == 2;
  return modbus::read_request(modbus::Function::read_registers, presence_register(channel.node()),
                              asks_for_two ? 3 : 2);
}

/// The first in the row to whose unit the line is free: one that is late keeps nobody else waiting.
Result<void> ModbusNetwork::pump() {
  if (client_.busy() || waiting_.empty()) return {};
  if (hand_over_late()) return {};
  const auto time = now();
  const auto next = std::find_if(waiting_.begin(), waiting_.end(),
                                 [&](const auto* channel) { return free_at(*channel) <= time; });
  if (next == waiting_.end()) return {};
  asking_ = *next;
  waiting_.erase(next);
  const auto bytes = client_.start(asking_->node(), asking_->pdu(), time, asking_->timeout(),
                                   {asking_->is_again(), check_for(*asking_)});
  const auto sent = port_->send(bytes);
  if (!sent) begin_anew();
  return sent;
}

/// Whoever asked is told by who steps: the line is lost for all of them.
void ModbusNetwork::begin_anew() {
  if (asking_ != nullptr) asking_->forget();
  for (auto* channel : waiting_) channel->forget();
  asking_ = nullptr;
  waiting_.clear();
  client_.reset();
}

Result<void> ModbusNetwork::check_stream() {
  if (!client_.broken()) return {};
  begin_anew();
  return fail(Errc::bus, message("{}: what came is no Modbus TCP", as_it_is(url_)),
              "is another service at this port? The next line connects anew");
}

Result<bool> ModbusNetwork::step(TimePoint deadline) {
  if (const auto sent = pump(); !sent) return fail(sent.error());
  const auto bytes = port_->receive(std::min(deadline, next_event()));
  stepped_at_ = now();
  if (!bytes) {
    begin_anew();
    return fail(bytes.error());
  }
  client_.on_bytes(*bytes, stepped_at_);
  client_.on_time(stepped_at_);
  if (const auto behind = client_.take_bytes(stepped_at_); !behind.empty())
    if (const auto sent = port_->send(behind); !sent) {
      begin_anew();
      return fail(sent.error());
    }
  if (const auto sound = check_stream(); !sound) return fail(sound.error());
  const auto outcome = client_.take_outcome();
  if (outcome && asking_ != nullptr) {
    if (outcome->echoed && !std::exchange(told_echo_, true))
      notices_.push_back(
          message("{}: the adapter hands back what it sends; that is left out", as_it_is(url_)));
    std::exchange(asking_, nullptr)->on_outcome(*outcome);
  }
  return outcome || !bytes->empty();
}

Result<void> ModbusNetwork::recover(TimePoint deadline) {
  begin_anew();
  return port_->reopen(deadline);
}

Result<void> ModbusNetwork::request_state(std::uint8_t node, NodeState) {
  return fail(drive_error(Errc::usage, node, "units of Modbus have no states"));
}

Result<void> ModbusNetwork::arm_watchdog(std::uint8_t node, const LifeSign&) {
  return fail(drive_error(Errc::usage, node, "Modbus has no signs of life"));
}

std::unique_ptr<ProcessValues> ModbusNetwork::process_values(std::uint8_t, std::span<const ObjectAddress>) {
  return std::make_unique<NoValues>();
}

std::string ModbusNetwork::write_frame(std::uint8_t node, ObjectAddress object, ByteSpan data) const {
  const auto address = register_of(node, object);
  if (!address || data.size() != 2) return {};
  const auto pdu = modbus::write_request(*address, static_cast<std::uint16_t>(load_le(data)));
  return to_hex(modbus::frame(client_.framing(), {node, 0, pdu}));
}

/// For the drive, and for twice eight characters on the line; what is behind a gateway is not known.
Duration ModbusNetwork::scan_patience() const {
  constexpr Duration kOfADrive = std::chrono::milliseconds(100);
  return client_.framing() == modbus::Framing::tcp ? 2 * kOfADrive : kOfADrive + 5 * port_->silence();
}

std::vector<Message> ModbusNetwork::take_notices() { return std::exchange(notices_, {}); }

std::string ModbusNetwork::silence_hint(std::uint8_t node) const {
  if (client_.framing() == modbus::Framing::tcp)
    return formatted("is {} its unit address? Behind a gateway: check line, speed and parity there", node);
  return formatted(
      "check power, cable (A and B swapped?), that its address is {}, and that speed, parity and {} are the "
      "drive's: {}",
      node, client_.framing() == modbus::Framing::ascii ? "ASCII" : "RTU", url_);
}

}  // namespace servoctl::session
