#include "session/session.hpp"

#include <algorithm>
#include <utility>

#include "session/can_network.hpp"
#include "session/interleave.hpp"
#include "session/transfer_run.hpp"
#include "session/wary.hpp"

namespace servoctl::session {
namespace {

/// Whoever cancels by a simulated clock, which only waits move on, is asked so often; who looks on is told.
constexpr Duration kCancelSlice = std::chrono::milliseconds(250);
/// Frames that come faster than they are read end no queue: so long is it read, and the clock asked so often.
constexpr Duration kListening = std::chrono::milliseconds(100);
constexpr std::size_t kClockEvery = 64;
/// So often who looks on is told that it goes on.
constexpr Duration kTelling = std::chrono::milliseconds(100);

}  // namespace

Session::Session(std::unique_ptr<Network> network, std::string url, Options options)
    : network_(std::move(network)),
      opened_at_(network_->now()),
      url_(std::move(url)),
      options_(std::move(options)),
      energised_(options_.protection) {
  network_->set_cancelled([this] { return options_.cancelled && options_.cancelled(); });
  network_->set_protection(options_.protection);
  if (options_.ordered)
    network_->set_ordered(
        [this](std::uint8_t node, std::string_view order) { options_.ordered(*this, node, order); });
}

Session::Session(std::unique_ptr<can::Bus> bus, std::string url, Options options)
    : Session(std::make_unique<CanNetwork>(std::move(bus), url), url, std::move(options)) {}

std::vector<Result<Bytes>> Session::transfer(std::span<const SdoRequest> requests) {
  if (options_.checks_numbers) consider_before(*this, requests);
  auto out = TransferRun(*this, requests).run();
  met_loss_ = met_loss_ || std::any_of(out.begin(), out.end(), [](const auto& result) {
                return !result && result.error().code == Errc::bus;
              });
  return out;
}

Result<Bytes> Session::upload(std::uint8_t node, ObjectAddress object) {
  const SdoRequest request{node, object, {}};
  return std::move(transfer(std::span(&request, 1)).front());
}

Result<void> Session::download(std::uint8_t node, ObjectAddress object, Bytes data) {
  const SdoRequest request{node, object, std::move(data)};
  const auto result = std::move(transfer(std::span(&request, 1)).front());
  if (!result) return fail(result.error());
  return {};
}

Result<bool> Session::step(TimePoint deadline) { return step(deadline, {}); }

Result<bool> Session::step(TimePoint deadline, const std::function<bool()>& concerns) {
  if (options_.cancelled) {
    // A signal that comes after this question ends the wait below at once: see wait_or_signal().
    if (options_.cancelled()) return fail(Errc::interrupted, "interrupted");
  }
  if (options_.until != kNever) {
    if (now() >= options_.until) return fail(Errc::interrupted, "the time is over");
    deadline = std::min(deadline, options_.until);
  }
  // What does not wait keeps nobody from going on.
  if (interleave_ != nullptr && interleave_->in_job() && deadline > received_at_)
    return interleave_->park(deadline, concerns);
  // A stale time ends the wait too early at most, and saves asking the clock once an arrival.
  const bool sliced = options_.cancelled || options_.waiting;
  return step_network(sliced ? std::min(deadline, received_at_ + kCancelSlice) : deadline);
}

Result<bool> Session::step_network(TimePoint deadline) {
  if (options_.beside)
    if (const auto free = options_.beside(); free != Duration::max())
      deadline = std::min(deadline, now() + free);
  auto stepped = network_->step(deadline);
  received_at_ = network_->stepped_at();
  met_loss_ = met_loss_ || (!stepped && stepped.error().code == Errc::bus);
  if (interleave_ != nullptr && stepped && *stepped) interleave_->taken_in_ |= interleave_->in_job();
  if (options_.waiting && received_at_ >= told_waiting_ + kTelling) tell_waiting();
  return stepped;
}

void Session::tell_waiting() {
  told_waiting_ = received_at_;
  options_.waiting(stretches_.empty() ? nullptr : stretches_.back(), received_at_);
}

Result<bool> Session::wait(const std::function<bool()>& done, TimePoint deadline) {
  while (!done()) {
    if (now() >= deadline) return false;
    if (const auto stepped = step(deadline, done); !stepped) return fail(stepped.error());
  }
  return true;
}

Result<void> Session::listen() {
  const auto end = now() + kListening;
  for (std::size_t taken = 1;; ++taken) {
    const auto stepped = step(now());
    if (!stepped) return fail(stepped.error());
    if (!*stepped || (taken % kClockEvery == 0 && now() >= end)) return {};
  }
}

std::vector<NodeEvent> Session::take_events() {
  std::vector<NodeEvent> out;
  while (auto event = network_->take_event()) {
    // Another drive may come in its place.
    if (std::holds_alternative<NodeEvent::Gone>(event->what)) {
      identities_.forget(event->node);
      doubt_numbers(event->node);
    }
    out.push_back(std::move(*event));
  }
  return out;
}

void Session::be_wary(std::uint8_t node, std::shared_ptr<const drive::Profile> profile) {
  wary_[node & 0x7FU] = {.profile = std::move(profile)};
}

void Session::be_wary(const Identity& numbers, std::shared_ptr<const drive::Profile> profile) {
  wary_[numbers.node & 0x7FU] = {std::move(profile), watch().boots(numbers.node), numbers.device_type};
}

std::unique_ptr<ObjectChannel> Session::lend_channel(std::uint8_t node) {
  auto channel = std::move(channels_[node & 0x7FU]);
  if (!channel) return network_->object_channel(node, options_.timeout);
  channel->set_timeout(options_.timeout);
  return channel;
}

void Session::give_back(std::uint8_t node, std::unique_ptr<ObjectChannel> channel) {
  if (!channel->busy()) channels_[node & 0x7FU] = std::move(channel);
}

}  // namespace servoctl::session
