#include "session/gateway_object_channel.hpp"

#include "base/base64.hpp"
#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/printable.hpp"
#include "canopen/sdo_abort.hpp"

namespace servoctl::session {
namespace {

/// What a gateway does beside waiting for the node.
constexpr Duration kOfTheGateway = std::chrono::seconds(10);
/// By segments at 10 kbit/s.
constexpr Duration kOfAByte = std::chrono::milliseconds(4);

/// Codes of the transfer itself (CiA 301, 7.2.4.3.17: 0503h and 0504h): what became of a write is not known.
bool is_broken_transfer(std::uint32_t abort) { return abort >> 16U == 0x0503 || abort >> 16U == 0x0504; }

}  // namespace

GatewayObjectChannel::~GatewayObjectChannel() { network_->leave(*this); }

void GatewayObjectChannel::start_upload(ObjectAddress object, TimePoint, canopen::Transfer, std::size_t) {
  object_ = object;
  writes_ = false;
  ask(formatted("{} {} r 0x{:04X} {} d", network_->address_.network, node_, object.index, object.sub));
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
  ask(formatted("{} {} w 0x{:04X} {} d {}", network_->address_.network, node_, object.index, object.sub,
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

namespace {

/// What the gateway says behind an abort code beside what that says; empty where that is all.
std::string told_beside(std::string_view text, std::string_view said) {
  if (text.starts_with('#')) text.remove_prefix(1);
  if (text.ends_with('.')) text.remove_suffix(1);
  if (text.starts_with(said)) text.remove_prefix(said.size());
  if (text.starts_with(": ")) text.remove_prefix(2);
  return text.empty() ? std::string() : formatted("the gateway says: {}", printable(text));
}

}  // namespace

Error GatewayObjectChannel::refusal(const gateway::Answer& answer) const {
  if (answer.kind == gateway::Answer::Kind::abort) {
    const auto said = canopen::sdo_abort_text(answer.number);
    const auto more = told_beside(answer.text, said);
    if (answer.number == canopen::sdo_abort::kTimeout)
      return drive_error(Errc::timeout, node_, object_, message("no answer within {}", to_string(timeout_)),
                         more);
    if (is_broken_transfer(answer.number))
      return drive_error(Errc::protocol, node_, object_,
                         message("the transfer broke off: {} (abort 0x{:08X})", said, answer.number), more);
    auto error = drive_error(
        Errc::sdo_abort, node_, object_,
        message("refused: {} (abort 0x{:08X})", canopen::sdo_abort_text(answer.number), answer.number),
        writes_ ? canopen::sdo_abort_hint(answer.number, object_) : canopen::sdo_abort_hint(answer.number));
    error.abort_code = answer.number;
    return error;
  }
  const auto meaning = gateway::code_text(answer.number);
  const bool says_more = answer.text.find(meaning) == std::string::npos;
  const auto what = says_more ? message("the gateway answers {} ({}) {}", answer.number, meaning,
                                        as_it_is(printable(answer.text)))
                              : message("the gateway answers {} ({})", answer.number, meaning);
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
                          message("the gateway answers '{}'", as_it_is(printable(answer.text.substr(0, 60)))),
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
