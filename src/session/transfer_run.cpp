#include "session/transfer_run.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "canopen/cob_id.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::session {
namespace {

constexpr int kNone = -1;
/// Bytes from which on a transfer is worth a word while it goes on.
constexpr std::size_t kLongTransfer = 1000;
/// Requests from which on a list is; a scan asks 127 nodes at once.
constexpr std::size_t kLongList = 128;

/// A heartbeat says that a node is stopped; of one that sends none nobody knows.
std::string silence_hint(const canopen::NodeWatch& watch, std::uint8_t node) {
  if (watch.state(node) == canopen::NmtState::stopped)
    return fmt::format("node {} is stopped (its heartbeat says so) and answers no SDO: `nmt preop -n {}`",
                       node, node);
  return fmt::format(
      "is node {} powered and connected, does it run at this bitrate and is this its node-ID? `scan` shows "
      "who answers; one that is stopped does not: `nmt preop -n {}`",
      node, node);
}

}  // namespace

TransferRun::TransferRun(Session& session, std::span<const SdoRequest> requests)
    : session_(&session),
      requests_(requests),
      results_(requests.size(), Result<Bytes>(Bytes{})),
      open_(requests.size()) {
  channel_of_node_.fill(kNone);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const auto node = requests[i].node & 0x7FU;
    if (channel_of_node_[node] == kNone) {
      channel_of_node_[node] = static_cast<int>(channels_.size());
      channels_.push_back({canopen::SdoClient(requests[i].node, session.options().timeout), {}, 0, 0});
    }
    channels_[static_cast<std::size_t>(channel_of_node_[node])].waiting.push_back(i);
  }
}

std::vector<Result<Bytes>> TransferRun::run() {
  for (auto& channel : channels_) start(channel);
  for (;;) {
    TimePoint next = kNever;
    for (auto& channel : channels_) {
      while (advance(channel)) {
      }
      next = std::min(next, channel.client.deadline());
    }
    if (open_ == 0) return std::move(results_);
    const auto frame = session_->receive(next);
    if (!frame) {
      fail_all(frame.error());
      return std::move(results_);
    }
    if (*frame) dispatch(**frame);
    const auto now = session_->received_at_;
    for (auto& channel : channels_)
      if (channel.client.deadline() <= now) channel.client.on_time(now);
  }
}

/// To the channel of the node that the frame belongs to by the pre-defined connection set: answers, what
/// other masters ask, boot-up.
void TransferRun::dispatch(const can::Frame& frame) {
  if (frame.id < canopen::kSdoAnswer || frame.id > canopen::kErrorControl + canopen::kLastNode) return;
  const int channel = channel_of_node_[frame.id & 0x7FU];
  if (channel == kNone) return;
  auto& client = channels_[static_cast<std::size_t>(channel)].client;
  client.on_frame(frame, session_->received_at_);
  if (session_->options().progress && client.total().value_or(client.transferred()) > kLongTransfer)
    session_->options().progress(client.transferred(), client.total(), session_->received_at_);
}

bool TransferRun::advance(Channel& channel) {
  if (const auto frame = channel.client.take_frame()) {
    if (const auto sent = session_->send(*frame); !sent) fail_all(sent.error());
    return true;
  }
  if (auto result = channel.client.take_result()) {
    finish(channel, std::move(*result));
    return true;
  }
  return false;
}

void TransferRun::start(Channel& channel) {
  if (channel.waiting.empty()) return;
  channel.current = channel.waiting.front();
  channel.waiting.pop_front();
  channel.tries = 0;
  const auto& request = requests_[channel.current];
  if (request.data)
    channel.client.start_download(request.object, *request.data, session_->now(), request.transfer);
  else
    channel.client.start_upload(request.object, session_->now(), request.transfer, request.size);
}

void TransferRun::finish(Channel& channel, Result<Bytes> result) {
  const auto& request = requests_[channel.current];
  const bool silent = !result && result.error().code == Errc::timeout;
  if (silent && !request.data && channel.tries < session_->options().retries) {
    ++channel.tries;
    // A server that knows no block transfer may meet its request with silence.
    const auto transfer =
        request.transfer == canopen::Transfer::domain ? canopen::Transfer::automatic : request.transfer;
    channel.client.start_upload(request.object, session_->now(), transfer, request.size);
    return;
  }
  if (silent && result.error().hint.empty())
    result.error().hint = silence_hint(session_->watch(), request.node);
  if (result && request.object == objects::kEmergencyCobId)
    learn_emergency_id(request.node, request.data ? *request.data : *result);
  results_[channel.current] = result;
  --open_;
  const auto& options = session_->options();
  if (options.list_progress && requests_.size() >= kLongList)
    options.list_progress(requests_.size() - open_, requests_.size(), session_->received_at_);
  if (!result && (silent || request.data)) skip_rest(channel, result.error(), silent);
  start(channel);
}

void TransferRun::learn_emergency_id(std::uint8_t node, ByteSpan data) {
  if (data.size() == 4) session_->watch().learn_emergency_id(node, static_cast<std::uint32_t>(load_le(data)));
}

void TransferRun::skip_rest(Channel& channel, const Error& reason, bool reads_too) {
  std::deque<std::size_t> kept;
  for (const auto index : channel.waiting) {
    if (!requests_[index].data && !reads_too) {
      kept.push_back(index);
      continue;
    }
    Error error = reason;  // Keeps the object that failed: that is the cause.
    error.message = fmt::format("node {}, object {}: not tried after {} failed", requests_[index].node,
                                to_string(requests_[index].object),
                                reason.object ? to_string(*reason.object) : "an object");
    results_[index] = tl::unexpected<Error>(std::move(error));
    --open_;
  }
  channel.waiting = std::move(kept);
}

void TransferRun::fail_all(const Error& error) {
  for (auto& channel : channels_) {
    if (channel.client.busy()) results_[channel.current] = tl::unexpected<Error>(error);
    for (const auto index : channel.waiting) results_[index] = tl::unexpected<Error>(error);
    channel = {canopen::SdoClient(channel.client.node(), session_->options().timeout), {}, 0, 0};
  }
  open_ = 0;
}

}  // namespace servoctl::session
