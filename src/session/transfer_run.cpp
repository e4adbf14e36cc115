#include "session/transfer_run.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "session/option_scope.hpp"
#include "session/wary.hpp"

namespace servoctl::session {
namespace {

constexpr int kNone = -1;
/// Bytes from which on a transfer is worth a word while it goes on.
constexpr std::size_t kLongTransfer = 1000;
/// Requests one after the other from which on a list is; a scan asks 127 nodes at once.
constexpr std::size_t kLongList = 40;
/// For an answer that is on its way when the time is over (Options::until).
constexpr Duration kGrace = std::chrono::milliseconds(20);

}  // namespace

TransferRun::TransferRun(Session& session, std::span<const SdoRequest> requests)
    : session_(&session),
      requests_(requests),
      results_(requests.size(), Result<Bytes>(Bytes{})),
      open_(requests.size()),
      until_(session.options().until) {
  channel_of_node_.fill(kNone);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const auto node = requests[i].node & 0x7FU;
    if (channel_of_node_[node] == kNone) {
      channel_of_node_[node] = static_cast<int>(channels_.size());
      auto& lane = channels_.emplace_back();
      lane.node = requests[i].node;
      lane.objects = session.lend_channel(requests[i].node);
    }
    auto& own = channels_[static_cast<std::size_t>(channel_of_node_[node])].requests;
    own.push_back(i);
    in_turn_ = std::max(in_turn_, own.size());
  }
  if (session.network().takes_turns()) in_turn_ = requests.size();
}

std::vector<Result<Bytes>> TransferRun::run() {
  const auto& cancelled = session_->options().cancelled;
  if (cancelled && cancelled()) return send_nothing();
  const OptionScope grace(*session_, &Options::until, until_ == kNever ? kNever : until_ + kGrace);
  for (auto& channel : channels_) start(channel);
  const std::function<bool()> stirred = [this] {
    return std::any_of(channels_.begin(), channels_.end(),
                       [](const Lane& channel) { return channel.objects->stirred(); });
  };
  for (;;) {
    TimePoint next = kNever;
    for (auto& channel : channels_) {
      serve(channel);
      next = std::min(next, channel.deadline);
    }
    if (open_ == 0) return give_back();
    const auto stepped = session_->step(next, stirred);
    if (!stepped) {
      fail_all(stepped.error());
      return give_back();
    }
    if (*stepped && session_->options().progress) tell_progress();
  }
}

/// Whoever was interrupted before asks and writes no more.
std::vector<Result<Bytes>> TransferRun::send_nothing() {
  for (auto& result : results_) result = fail(Errc::interrupted, "interrupted");
  return give_back();
}

/// The channels are ready for the next run.
std::vector<Result<Bytes>> TransferRun::give_back() {
  for (auto& channel : channels_) session_->give_back(channel.node, std::move(channel.objects));
  return std::move(results_);
}

void TransferRun::tell_progress() {
  for (auto& channel : channels_) {
    const auto done = channel.objects->transferred();
    const auto total = channel.objects->total();
    // What is about to begin has no more to send either.
    if (done == channel.told || (channel.objects->busy() && done == total)) continue;
    channel.told = done;
    if (total.value_or(done) > kLongTransfer)
      session_->options().progress(done, total, session_->received_at());
  }
}

/// One arrival concerns one channel; the others are not asked again before their deadline.
void TransferRun::serve(Lane& channel) {
  if (!channel.objects->stirred() && channel.deadline > session_->received_at()) return;
  while (advance(channel)) {
  }
  channel.deadline = channel.objects->deadline();
}

bool TransferRun::advance(Lane& channel) {
  if (const auto sent = channel.objects->on_time(session_->received_at()); !sent) {
    fail_all(sent.error());
    return false;
  }
  auto result = channel.objects->take_result();
  if (!result) return false;
  finish(channel, std::move(*result));
  return true;
}

void TransferRun::start(Lane& channel) {
  while (channel.started != channel.requests.size()) {
    if (until_ != kNever && session_->now() >= until_) {
      open_ -= channel.requests.size() - channel.started;
      for (; channel.started < channel.requests.size(); ++channel.started)
        results_[channel.requests[channel.started]] = fail(Errc::interrupted, "the time is over");
      return;
    }
    channel.current = channel.requests[channel.started++];
    channel.tries = 0;
    if (!answer_for(channel)) return ask(channel, requests_[channel.current].transfer);
  }
}

/// True where the request would raise an access alarm: it is not sent, and its result is the refusal.
bool TransferRun::answer_for(Lane& channel) {
  const auto& request = requests_[channel.current];
  auto refusal = request.despite_alarm ? std::nullopt : refusal_of(*session_, request.node, request.object);
  if (!refusal) return false;
  results_[channel.current] = fail(std::move(*refusal));
  if (request.ended != nullptr) *request.ended = session_->now();
  --open_;
  if (request.data) skip_rest(channel, results_[channel.current].error(), false);
  return true;
}

void TransferRun::ask(Lane& channel, canopen::Transfer transfer) {
  const auto& request = requests_[channel.current];
  channel.told = 0;
  channel.asked = true;
  const auto now = session_->now();
  if (channel.tries == 0) channel.begun = now;
  if (request.data)
    channel.objects->start_download(request.object, *request.data, now, transfer);
  else
    channel.objects->start_upload(request.object, now, transfer, request.size);
}

/// What has become of the present request.
void TransferRun::tell(const Lane& channel, TimePoint ended) const {
  const auto& request = requests_[channel.current];
  if (const auto& exchanged = session_->options().exchanged)
    exchanged({*session_, request.node, request.object, request.data ? &*request.data : nullptr,
               results_[channel.current], channel.begun, ended, channel.tries + 1});
}

void TransferRun::finish(Lane& channel, Result<Bytes> result) {
  channel.asked = false;
  const auto& request = requests_[channel.current];
  const bool silent = !result && result.error().code == Errc::timeout;
  if (silent && !request.data && channel.tries < session_->options().retries) {
    ++channel.tries;
    channel.objects->try_again();
    // A server that knows no block transfer may meet its request with silence.
    return ask(channel, request.transfer == canopen::Transfer::domain ? canopen::Transfer::automatic
                                                                      : request.transfer);
  }
  if (silent) session_->doubt_numbers(request.node);
  if (silent && result.error().hint.empty())
    result.error().hint = session_->network().silence_hint(request.node);
  auto& place = results_[channel.current];
  place = std::move(result);
  tell(channel, place ? session_->received_at() : session_->network().stepped_at());
  if (request.ended != nullptr) *request.ended = session_->network().stepped_at();
  --open_;
  const auto& options = session_->options();
  if (options.list_progress && in_turn_ >= kLongList)
    options.list_progress(requests_.size() - open_, requests_.size(), session_->received_at());
  if (!place && (silent || request.data)) skip_rest(channel, place.error(), silent);
  start(channel);
}

void TransferRun::skip_rest(Lane& channel, const Error& reason, bool reads_too) {
  const auto skipped = [&](std::size_t index) {
    if (!requests_[index].data && !reads_too) return false;
    Error error = reason;  // Keeps the object that failed: that is the cause.
    error.message =
        message("node {}, object {}: skipped because {} failed", node_name(requests_[index].node),
                to_string(requests_[index].object), reason.object ? to_string(*reason.object) : "an object");
    results_[index] = fail(std::move(error));
    --open_;
    return true;
  };
  const auto rest = channel.requests.begin() + static_cast<std::ptrdiff_t>(channel.started);
  channel.requests.erase(std::remove_if(rest, channel.requests.end(), skipped), channel.requests.end());
}

/// What was asked and what came of it is not known any more, though the transfer itself may have ended: its
/// abort may be what was not sent. The channels begin anew.
void TransferRun::fail_all(const Error& error) {
  for (auto& channel : channels_) {
    if (channel.asked) {
      results_[channel.current] = fail(error);
      tell(channel, session_->now());
    }
    for (; channel.started < channel.requests.size(); ++channel.started)
      results_[channel.requests[channel.started]] = fail(error);
    channel.asked = false;
    channel.objects = session_->network().object_channel(channel.node, session_->options().timeout);
  }
  open_ = 0;
}

}  // namespace servoctl::session
