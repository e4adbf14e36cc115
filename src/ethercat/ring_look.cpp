#include "ethercat/ring_look.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "ethercat/registers.hpp"

namespace servoctl::ethercat {
namespace {

constexpr std::size_t kMostSlaves = 127;
constexpr std::size_t kIdentitySize = 20;
constexpr std::size_t kErrorsSize = 20;

std::uint8_t byte_or_zero(ByteSpan bytes, std::size_t at) {
  return at < bytes.size() ? bytes[at] : std::uint8_t{0};
}
std::uint16_t word_or_zero(ByteSpan bytes, std::size_t at) {
  return static_cast<std::uint16_t>(byte_or_zero(bytes, at) | byte_or_zero(bytes, at + 1) << 8U);
}

}  // namespace

SlaveLook parse_slave_look(ByteSpan identity, ByteSpan dl_status, ByteSpan al_status, ByteSpan errors) {
  SlaveLook out;
  out.type = byte_or_zero(identity, reg::kType);
  out.revision = byte_or_zero(identity, reg::kType + 1);
  out.fmmus = byte_or_zero(identity, reg::kFmmuCount);
  out.sync_managers = byte_or_zero(identity, reg::kSyncManagers);
  out.features = word_or_zero(identity, reg::kFeatures);
  out.station = word_or_zero(identity, reg::kStationAddress);
  out.alias = word_or_zero(identity, reg::kStationAlias);
  out.al = parse_al_status(al_status);
  const auto dl = word_or_zero(dl_status, 0);
  const auto at = [](std::uint16_t where) { return static_cast<std::size_t>(where - reg::kErrorCounters); };
  for (unsigned port = 0; port < 4; ++port) {
    auto& look = out.ports[port];
    look.link = (dl & reg::dl_link(port)) != 0;
    look.open = (dl & reg::dl_loop(port)) == 0;
    look.signal = (dl & reg::dl_signal(port)) != 0;
    look.bad_frames = byte_or_zero(errors, at(reg::kRxErrors) + 2 * port);
    look.bad_symbols = byte_or_zero(errors, at(reg::kRxErrors) + 2 * port + 1);
    look.forwarded = byte_or_zero(errors, at(reg::kForwardedErrors) + port);
    look.lost_links = byte_or_zero(errors, at(reg::kLostLinks) + port);
  }
  out.bad_commands = byte_or_zero(errors, at(reg::kProcessingErrors));
  out.pdi_errors = byte_or_zero(errors, at(reg::kPdiErrors));
  return out;
}

bool RingLook::View::is_in_use() const {
  return std::any_of(slaves.begin(), slaves.end(), [](const SlaveLook& slave) {
    return slave.al.state == AlState::safeop || slave.al.state == AlState::op;
  });
}

void RingLook::start(TimePoint) {
  view_ = {};
  result_.reset();
  go(State::count);
}

void RingLook::go(State state) {
  state_ = state;
  asking_ = true;
}

std::optional<Request> RingLook::take_request() {
  if (!std::exchange(asking_, false)) return std::nullopt;
  switch (state_) {
    case State::idle: return std::nullopt;
    case State::count: return Request{Command::brd, physical_address(0, reg::kType), Bytes(2), true};
    case State::identity: return read_registers(present(), reg::kType, kIdentitySize);
    case State::dl_status: return read_registers(present(), reg::kDlStatus, 2);
    case State::al_status: return read_registers(present(), reg::kAlStatus, reg::kAlStatusSize);
    case State::errors: return read_registers(present(), reg::kErrorCounters, kErrorsSize);
  }
  return std::nullopt;
}

void RingLook::on_answer(const Answer& answer, TimePoint) {
  if (state_ == State::idle) return;
  if (state_ == State::count) return on_counted(answer);
  // The count may have come back short: one more is asked for, which is not there as a rule.
  const bool behind = state_ == State::identity && view_.slaves.size() == view_.count;
  if (behind && !answer.done()) return finish(std::move(view_));
  if (behind) ++view_.count;
  if (!answer.done()) {
    const auto position = view_.slaves.size() + 1;
    auto gone = make_error(Errc::timeout, message("the slave at position {} no longer answers", position),
                           "was a cable pulled or its supply switched off? Try again");
    gone.node = static_cast<std::uint8_t>(position);
    return finish(fail(std::move(gone)));
  }
  switch (state_) {
    case State::identity:
      read_[0].assign(answer.data.begin(), answer.data.end());
      return go(State::dl_status);
    case State::dl_status:
      read_[1].assign(answer.data.begin(), answer.data.end());
      return go(State::al_status);
    case State::al_status: read_[2].assign(answer.data.begin(), answer.data.end()); return go(State::errors);
    default: break;
  }
  view_.slaves.push_back(parse_slave_look(read_[0], read_[1], read_[2], answer.data));
  if (view_.slaves.size() == kMostSlaves) return finish(std::move(view_));
  go(State::identity);
}

void RingLook::on_counted(const Answer& answer) {
  if (answer.lost)
    return finish(fail(
        Errc::bus, "frames do not come back",
        "is this the right interface, and is its cable plugged into the IN port of the first drive, without a switch in between?"));
  if (answer.working_counter == 0)
    return finish(fail(
        Errc::bus, "no EtherCAT slave is there",
        "frames come back and nobody has touched them: the cable leads to a switch or back to this computer, not to an EtherCAT slave"));
  view_.count = answer.working_counter;
  go(State::identity);
}

void RingLook::finish(Result<View> result) {
  state_ = State::idle;
  asking_ = false;
  result_ = std::move(result);
}

std::optional<Result<RingLook::View>> RingLook::take_result() { return std::exchange(result_, std::nullopt); }

}  // namespace servoctl::ethercat
