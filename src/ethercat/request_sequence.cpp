#include "ethercat/request_sequence.hpp"

#include <utility>

#include "base/format.hpp"
#include "ethercat/registers.hpp"

namespace servoctl::ethercat {
namespace {

constexpr std::size_t kFmmus = 3;  ///< That every slave has that has any.
constexpr std::size_t kManagers = 4;

Request broadcast(std::uint16_t where, Bytes data) {
  return {Command::bwr, physical_address(0, where), std::move(data), true};
}

bool is_broadcast(Command command) { return command >= Command::brd && command <= Command::brw; }

}  // namespace

void RequestSequence::start(std::vector<Request> requests) {
  requests_ = std::move(requests);
  next_ = 0;
  answers_.clear();
  result_.reset();
  asking_ = !requests_.empty();
  if (requests_.empty()) result_ = std::vector<Bytes>{};
}

std::optional<Request> RequestSequence::take_request() {
  if (!std::exchange(asking_, false)) return std::nullopt;
  return requests_[next_];
}

void RequestSequence::on_answer(const Answer& answer, TimePoint) {
  if (!busy()) return;
  const auto& request = requests_[next_];
  const bool none = !answer.done() && !is_broadcast(request.command);
  if (answer.lost || none) {
    const auto what = message("register {:04X}h cannot be {}: {}", request.address >> 16U,
                              writes(request.command) ? "written" : "read",
                              answer.lost ? "frames do not come back" : "it does not answer");
    const auto* hint = "is it powered, and is the cable plugged in? `scan` shows which slaves answer";
    next_ = requests_.size();
    result_ = node_ != 0 ? fail(drive_error(Errc::timeout, node_, what, hint)) : fail(Errc::bus, what, hint);
    return;
  }
  answers_.emplace_back(answer.data.begin(), answer.data.end());
  ++next_;
  asking_ = busy();
  if (!busy()) result_ = std::exchange(answers_, {});
}

std::optional<Result<std::vector<Bytes>>> RequestSequence::take_result() {
  return std::exchange(result_, std::nullopt);
}

std::vector<Request> default_settings() {
  return {
      broadcast(reg::kDlControlAlias, {0}),
      broadcast(reg::kDlControl + 1, {0}),
      broadcast(reg::kErrorCounters, Bytes(8)),
      broadcast(reg::kFmmu, Bytes(kFmmus * reg::kFmmuSize)),
      broadcast(reg::kSyncManager, Bytes(kManagers * reg::kSyncManagerSize)),
      broadcast(reg::kDcActivation, {0}),
      broadcast(reg::kDcSystemTime, Bytes(4)),
      broadcast(reg::kDcSpeedStart, store_le(0x1000, 2)),
      broadcast(reg::kDcFilter, store_le(0x0C00, 2)),
      broadcast(reg::kSiiAccess, {reg::kSiiForce}),
      broadcast(reg::kSiiAccess, {0}),
  };
}

std::vector<Request> station_setup(std::uint16_t position, std::uint16_t station) {
  return {write_registers(SlaveAddress::at_position(position), reg::kStationAddress, store_le(station, 2))};
}

}  // namespace servoctl::ethercat
