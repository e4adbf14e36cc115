#include "session/gateway_object_channel.hpp"

#include <fmt/format.h>

#include "base/base64.hpp"
#include "base/duration.hpp"
#include "base/printable.hpp"
#include "canopen/sdo_abort.hpp"

namespace servoctl::session {
namespace {

/// What a gateway does beside waiting for the node.
constexpr Duration kOfTheGateway = std::chrono::seconds(10);
/// By segments at 10 kbit/s.
constexpr Duration kOfAByte = std::chrono::milliseconds(4);

}  // namespace

GatewayObjectChannel::~GatewayObjectChannel() { network_->leave(*this); }

void GatewayObjectChannel::start_upload(ObjectAddress object, TimePoint, canopen::Transfer, std::size_t) {
  object_ = object;
  writes_ = false;
  ask(fmt::format("{} {} r 0x{:04X} {} d", network_->address_.network, node_, object.index, object.sub));
}

void GatewayObjectChannel::start_download(ObjectAddress object, Bytes data, TimePoint, canopen::Transfer) {
  object_ = object;
  writes_ = true;
  if (data.empty()) {
    stirred_ = true;
    result_ = fail(drive_error(Errc::usage, node_, object_, "over a gateway a write has at least one byte",
                               "nothing was sent"));
    return;
  }
  ask(fmt::format("{} {} w 0x{:04X} {} d {}", network_->address_.network, node_, object.index, object.sub,
                  to_base64(data)));
}

void GatewayObjectChannel::ask(std::string request) {
  stirred_ = true;
  request_ = std::move(request);
  network_->waiting_.push_back(this);
}

Result<void> GatewayObjectChannel::on_time(TimePoint) {
  stirred_ = false;
  return network_->pump();
}

TimePoint GatewayObjectChannel::deadline() const { return busy() ? network_->next_event() : kNever; }

Duration GatewayObjectChannel::patience() const {
  return timeout_ + kOfTheGateway + static_cast<Duration::rep>(request_.size()) * kOfAByte;
}

Error GatewayObjectChannel::refusal(const gateway::Answer& answer) const {
  if (answer.kind == gateway::Answer::Kind::abort) {
    if (answer.number == canopen::sdo_abort::kTimeout)
      return drive_error(Errc::timeout, node_, object_,
                         fmt::format("no answer within {}", to_string(timeout_)));
    auto error = drive_error(
        Errc::sdo_abort, node_, object_,
        fmt::format("refused: {} (abort 0x{:08X})", canopen::sdo_abort_text(answer.number), answer.number),
        writes_ ? canopen::sdo_abort_hint(answer.number, object_) : canopen::sdo_abort_hint(answer.number));
    error.abort_code = answer.number;
    return error;
  }
  const auto meaning = gateway::code_text(answer.number);
  const bool says_more = answer.text.find(meaning) == std::string::npos;
  const auto what = says_more ? fmt::format("the gateway answers {} ({}) {}", answer.number, meaning,
                                            printable(answer.text))
                              : fmt::format("the gateway answers {} ({})", answer.number, meaning);
  switch (static_cast<gateway::Code>(answer.number)) {
    case gateway::Code::timeout: return drive_error(Errc::timeout, node_, object_, what);
    case gateway::Code::internal_state:
      return drive_error(Errc::refused, node_, object_, what,
                         "one of servoctl only reads unless it was started with --allow write");
    case gateway::Code::unsupported_network:
    case gateway::Code::unsupported_node:
      return drive_error(Errc::usage, node_, object_, what,
                         "the network stands in the URL: gateway://HOST/1");
    default:
      return drive_error(Errc::protocol, node_, object_, what,
                         "it has to know reads and writes of domains (`d`), and lines as long as the value");
  }
}

Result<Bytes> GatewayObjectChannel::result_of(const gateway::Client::Outcome& outcome) const {
  using Kind = gateway::Answer::Kind;
  const auto& answer = outcome.answer;
  if (answer.kind == Kind::error || answer.kind == Kind::abort) return fail(refusal(answer));
  if (writes_ && answer.kind == Kind::ok) return Bytes();
  if (!writes_ && answer.kind == Kind::value)
    if (auto bytes = parse_base64(answer.text)) return std::move(*bytes);
  return fail(drive_error(Errc::protocol, node_, object_,
                          fmt::format("the gateway answers '{}'", printable(answer.text.substr(0, 60))),
                          "is it one of CiA 309-3, in its ASCII form?"));
}

void GatewayObjectChannel::on_outcome(const gateway::Client::Outcome& outcome) {
  stirred_ = true;
  result_ = result_of(outcome);
  request_.clear();
}

void GatewayObjectChannel::forget() {
  request_.clear();
  stirred_ = true;
}

}  // namespace servoctl::session
