#include "session/modbus_object_channel.hpp"

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/open_requests.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::session {
namespace {

using modbus::Outcome;

constexpr std::size_t kRegisterBytes = 2;
/// Between two requests to a unit that is busy.
constexpr Duration kBusyPause = std::chrono::milliseconds(20);

}  // namespace

ModbusObjectChannel::~ModbusObjectChannel() { network_->leave(*this); }

void ModbusObjectChannel::start_upload(ObjectAddress object, TimePoint, canopen::Transfer, std::size_t size) {
  object_ = object;
  stirred_ = true;
  const auto address = network_->register_of(node_, object);
  if (object == objects::kDeviceType && !address)
    return ask(Way::presence,
               modbus::read_request(modbus::Function::read_registers, network_->presence_register(node_), 1));
  if (!address) return refuse_unknown(object);
  if (size != 0 && size != kRegisterBytes)
    return refuse(object, formatted("it has {} bytes, and a register has 2", size), {});
  ask(Way::read, modbus::read_request(modbus::Function::read_registers, *address, 1));
}

void ModbusObjectChannel::start_download(ObjectAddress object, Bytes data, TimePoint, canopen::Transfer) {
  object_ = object;
  stirred_ = true;
  const auto address = network_->register_of(node_, object);
  if (!address) return refuse_unknown(object);
  if (data.size() != kRegisterBytes)
    return refuse(object, formatted("{} bytes do not go into a register, which has 2", data.size()),
                  "nothing was sent");
  ask(Way::write, modbus::write_request(*address, static_cast<std::uint16_t>(load_le(data))));
}

void ModbusObjectChannel::start_request(Bytes pdu) {
  object_ = {};
  stirred_ = true;
  ask(Way::request, std::move(pdu));
}

void ModbusObjectChannel::ask(Way way, Bytes pdu) {
  way_ = way;
  pdu_ = std::move(pdu);
  not_before_ = TimePoint::min();
  busy_until_ = kNever;
  network_->waiting_.push_back(this);
}

/// An object that cannot be reached is one that this network does not have: what only looks goes on.
void ModbusObjectChannel::refuse_unknown(ObjectAddress object) {
  if (network_->is_known(node_))
    return refuse(object, "it has no Modbus register",
                  "`objects` and `param list` show what there is; the "
                  "parameters of the panel have registers");
  result_ = fail(drive_error(Errc::usage, node_, object,
                             "which register it stands in is told by the family's data alone",
                             "add -d FAMILY; `drives` lists families"));
}

void ModbusObjectChannel::refuse(ObjectAddress object, std::string what, std::string hint) {
  result_ = fail(drive_error(Errc::sdo_abort, node_, object, what, std::move(hint)));
}

Result<void> ModbusObjectChannel::on_time(TimePoint) {
  stirred_ = false;
  return network_->pump();
}

TimePoint ModbusObjectChannel::deadline() const { return busy() ? network_->next_event() : kNever; }

std::string ModbusObjectChannel::what_text() const {
  if (way_ == Way::request) return formatted("function {:02X}h", pdu_.front());
  return formatted("register {:04X}h", modbus::load_be16(ByteSpan(pdu_).subspan(1)));
}

Error ModbusObjectChannel::refusal(std::uint8_t exception) const {
  const auto meaning = modbus::exception_meaning(exception);
  const auto what = formatted("{} of {} was {}: Modbus exception {:02X}h, {}{}{}",
                              way_ == Way::write ? "the write" : "the read", what_text(),
                              modbus::is_open(exception) ? "not answered" : "refused", exception,
                              modbus::exception_name(exception), meaning.empty() ? "" : ": ", meaning);
  const auto code = modbus::is_open(exception) ? Errc::timeout : Errc::sdo_abort;
  if (way_ == Way::request) return drive_error(code, node_, what);
  return drive_error(code, node_, object_, what);
}

/// What came in instead says more than that nothing did.
Error ModbusObjectChannel::silence(const Outcome& outcome) const {
  auto out = drive_error(Errc::timeout, node_, object_, message("no answer within {}", to_string(timeout_)));
  if (way_ == Way::request || way_ == Way::presence)
    out = drive_error(Errc::timeout, node_, message("no answer within {}", to_string(timeout_)));
  if (outcome.late) {
    out.message += lateness_text(*outcome.late);
    out.hint = lateness_hint(*outcome.late);
  } else if (outcome.other_unit) {
    out.message += message("; unit {} answered instead", *outcome.other_unit);
    out.hint = "do two units, or two masters, talk on this line?";
  } else if (outcome.damaged > 0) {
    out.message += message("; {} bytes came that are no message", outcome.damaged);
    out.hint = message(
        "has the drive another speed, parity or form of frames than {}? Two units of one address, and noise "
        "on the cable, look the same",
        as_it_is(network_->url()));
  } else if (outcome.other_answer) {
    out.message += "; an answer to another request came";
    out.hint = "a drive that answers late needs a longer --timeout; is another master on this line?";
  } else if (outcome.echoed) {
    out.message += "; only the request itself came back";
    out.hint = "the adapter hands back what it sends, and nobody answers: check power, address and cable";
  }
  return out;
}

void ModbusObjectChannel::on_outcome(const Outcome& outcome) {
  stirred_ = true;
  switch (outcome.kind) {
    case Outcome::Kind::silent: return finish(fail(silence(outcome)));
    case Outcome::Kind::malformed:
      if (way_ == Way::presence) break;
      return finish(fail(drive_error(Errc::protocol, node_, object_,
                                     message("the answer to {} has another length than was asked for: {}",
                                             what_text(), to_hex(outcome.pdu)),
                                     "is this device what -d says?")));
    case Outcome::Kind::refused:
      if (repeats_while_busy(outcome.pdu[1])) return;
      if (modbus::is_open(outcome.pdu[1])) return finish(fail(refusal(outcome.pdu[1])));
      if (way_ == Way::presence) break;
      return finish(fail(refusal(outcome.pdu[1])));
    case Outcome::Kind::answered: break;
  }
  if (way_ == Way::presence)
    return finish(fail(drive_error(Errc::sdo_abort, node_, object_, "a unit of Modbus has no such object")));
  if (way_ == Way::write) return finish(Bytes());
  if (way_ == Way::request) return finish(outcome.pdu);
  finish(store_le(modbus::load_be16(ByteSpan(outcome.pdu).subspan(2)), kRegisterBytes));
}

/// A busy unit has done nothing of the request: it is asked once more, until its time is over.
bool ModbusObjectChannel::repeats_while_busy(std::uint8_t exception) {
  if (exception != static_cast<std::uint8_t>(modbus::Exception::device_busy)) return false;
  const auto now = network_->now();
  if (busy_until_ == kNever) busy_until_ = now + timeout_;
  if (now + kBusyPause > busy_until_) return false;
  not_before_ = now + kBusyPause;
  network_->waiting_.push_back(this);
  return true;
}

void ModbusObjectChannel::finish(Result<Bytes> result) {
  result_ = std::move(result);
  again_ = false;
  pdu_.clear();
}

void ModbusObjectChannel::forget() {
  pdu_.clear();
  stirred_ = true;
}

}  // namespace servoctl::session
