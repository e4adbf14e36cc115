#include "session/session.hpp"

#include <algorithm>
#include <utility>

#include "canopen/cob_id.hpp"
#include "canopen/nmt.hpp"
#include "session/transfer_run.hpp"

namespace servoctl::session {
namespace {

/// Whoever cancels by a simulated clock, which only waits move on, is asked so often.
constexpr Duration kCancelSlice = std::chrono::milliseconds(250);

}  // namespace

Session::Session(std::unique_ptr<can::Bus> bus, std::string url, Options options)
    : bus_(std::move(bus)),
      opened_at_(bus_->now()),
      url_(std::move(url)),
      options_(std::move(options)),
      energised_(options_.protection) {}

std::vector<Result<Bytes>> Session::transfer(std::span<const SdoRequest> requests) {
  return TransferRun(*this, requests).run();
}

Result<Bytes> Session::upload(std::uint8_t node, ObjectAddress object) {
  const SdoRequest request{node, object, {}};
  return std::move(transfer(std::span(&request, 1)).front());
}

Result<void> Session::download(std::uint8_t node, ObjectAddress object, Bytes data) {
  const SdoRequest request{node, object, std::move(data)};
  const auto result = std::move(transfer(std::span(&request, 1)).front());
  if (!result) return tl::unexpected<Error>(result.error());
  return {};
}

Result<std::optional<can::Frame>> Session::receive(TimePoint deadline) {
  if (options_.cancelled) {
    // A signal that comes after this question ends the wait below at once: see wait_or_signal().
    if (options_.cancelled()) return fail(Errc::interrupted, "interrupted");
    // A stale time ends the wait too early at most, and saves asking the clock once a frame.
    deadline = std::min(deadline, received_at_ + kCancelSlice);
  }
  while (const auto question = guard_.take_frame())
    if (const auto sent = bus_->send(*question); !sent) return tl::unexpected<Error>(sent.error());
  const auto heartbeat = send_heartbeat();
  if (!heartbeat) return tl::unexpected<Error>(heartbeat.error());
  const auto sync = send_sync();
  if (!sync) return tl::unexpected<Error>(sync.error());
  auto frame = bus_->receive(std::min({deadline, watch_.deadline(), guard_.deadline(), *heartbeat, *sync}));
  if (!frame) return frame;
  received_at_ = *frame ? std::max(received_at_, bus_->arrived()) : now();
  if (*frame) watch_.on_frame(**frame, received_at_);
  if (*frame) duplicates_.on_frame(**frame, received_at_);
  if (*frame) guard_.on_frame(**frame, received_at_);
  if (*frame && sync_ && !(*frame)->extended && (*frame)->id == sync_->options.can_id) ++sync_->foreign;
  if (*frame && options_.heard) options_.heard(**frame, received_at_);
  watch_.on_time(received_at_);
  guard_.on_time(received_at_);
  if (const auto report = *frame ? can::parse_report(**frame) : std::nullopt)
    if (const auto alive = on_report(*report); !alive) return tl::unexpected<Error>(alive.error());
  return frame;
}

Result<TimePoint> Session::send_heartbeat() {
  if (!heartbeat_) return kNever;
  const auto time = now();
  if (time < heartbeat_->next) return heartbeat_->next;
  heartbeat_->next = time + heartbeat_->period;
  if (const auto sent =
          bus_->send(canopen::heartbeat_frame(heartbeat_->node, canopen::NmtState::operational));
      !sent)
    return tl::unexpected<Error>(sent.error());
  return heartbeat_->next;
}

Result<TimePoint> Session::send_sync() {
  if (!sync_) return kNever;
  sync_->producer.on_time(now());
  if (const auto frame = sync_->producer.take_frame()) {
    if (const auto sent = bus_->send(*frame); !sent) return tl::unexpected<Error>(sent.error());
    sync_->rhythm.add(now());
  }
  return sync_->producer.deadline();
}

Result<void> Session::on_report(can::ControllerReport report) {
  if (report == can::ControllerReport::bus_off) {
    last_report_.reset();
    return fail(Errc::bus, url_ + ": " + std::string(can::text(report)),
                "check bitrate, wiring and termination; then take the interface down and up again "
                "(`ip link set … restart-ms 100` lets it come back by itself)");
  }
  if (report != last_report_) reports_.push_back(report);
  last_report_ = report;
  return {};
}

Result<bool> Session::wait(const std::function<bool()>& done, TimePoint deadline) {
  while (!done()) {
    if (now() >= deadline) return false;
    if (const auto frame = receive(deadline); !frame) return tl::unexpected<Error>(frame.error());
  }
  return true;
}

Result<void> Session::listen() {
  for (;;) {
    const auto frame = receive(now());
    if (!frame) return tl::unexpected<Error>(frame.error());
    if (!*frame) return {};
  }
}

std::vector<canopen::NodeEvent> Session::take_events() {
  std::vector<canopen::NodeEvent> out;
  while (const auto event = watch_.take_event()) out.push_back(*event);
  while (const auto event = guard_.take_event()) out.push_back(*event);
  while (const auto event = duplicates_.take_event()) out.push_back(*event);
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  return out;
}

void Session::guard(std::uint8_t node, canopen::GuardOptions options) {
  watch_.set_guarded(node, true);
  guard_.start(node, options, now());
  guard_.on_time(now());
}

void Session::stop_guarding() {
  for (std::uint8_t node = canopen::kFirstNode; node <= canopen::kLastNode; ++node) {
    watch_.set_guarded(node, false);
    guard_.stop(node);
  }
}

TimePoint Session::next_event() const {
  return std::min({bus_->next_event(), watch_.deadline(), guard_.deadline(),
                   heartbeat_ ? heartbeat_->next : kNever, sync_ ? sync_->producer.deadline() : kNever});
}

}  // namespace servoctl::session
