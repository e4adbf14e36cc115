#include "traffic/replay_run.hpp"

#include <algorithm>

#include "canopen/cob_id.hpp"
#include "session/hearing.hpp"
#include "session/stretch.hpp"

namespace servoctl::traffic {
namespace {

using Kind = canopen::SdoStep::Kind;

/// The node of a frame of the default SDO channel, 0 for other frames.
std::uint8_t node_at(const can::Frame& frame, std::uint32_t base) {
  const bool fits = !frame.remote && frame.id > base && frame.id <= base + canopen::kLastNode;
  return fits ? static_cast<std::uint8_t>(frame.id - base) : std::uint8_t{0};
}

/// Whether the server says with it that it has heard a request.
bool is_answer(const canopen::SdoStep& step) {
  return step.object &&
         (step.kind == Kind::answer || step.kind == Kind::acknowledge || step.kind == Kind::abort);
}

template <class Requests>
auto find_request(Requests& open, ObjectAddress object) {
  return std::find_if(open.begin(), open.end(),
                      [&](const auto& request) { return request.object == object; });
}

}  // namespace

Result<void> ReplayRun::run(std::span<const can::LogFrame> frames, double speed) {
  const session::Hearing hearing(*session_,
                                 [this](const can::Frame& frame, TimePoint) { on_received(frame); });
  auto done = send_all(frames, speed);
  if (done) {
    const auto waited =
        session_->wait([this] { return !is_waiting(); }, session_->now() + session_->options().timeout);
    if (!waited) done = fail(waited.error());
  }
  close();
  return done;
}

Result<void> ReplayRun::send_all(std::span<const can::LogFrame> frames, double speed) {
  auto due = session_->now();
  session::Stretch stretch(*session_, kNever);
  while (sent_ < frames.size()) {
    const auto waited = session_->wait([] { return false; }, due);
    if (!waited) return fail(waited.error());
    if (const auto done = session_->can()->send(frames[sent_].frame); !done) return done;
    on_sent(frames[sent_].frame);
    ++sent_;
    stretch.set_share(static_cast<double>(sent_) / static_cast<double>(frames.size()));
    if (sent_ == frames.size()) break;
    const auto gap = std::max(frames[sent_].time - frames[sent_ - 1].time, Duration::zero());
    due += std::chrono::duration_cast<Duration>(gap / speed);
  }
  return {};
}

void ReplayRun::on_sent(const can::Frame& frame) {
  if (const auto node = node_at(frame, canopen::kSdoRequest); node != 0) {
    auto& channel = channels_[node];
    const auto step = channel.live.on_client_frame(frame);
    if (!step.object) return;
    if (step.kind == Kind::read || step.kind == Kind::write)
      channel.open.push_back({*step.object, step.kind == Kind::write});
    // The client gave up in the recording: no answer is due.
    if (step.kind == Kind::abort)
      if (const auto at = find_request(channel.open, *step.object); at != channel.open.end())
        channel.open.erase(at);
  } else if (const auto server = node_at(frame, canopen::kSdoAnswer); server != 0) {
    auto& channel = channels_[server];
    const auto step = channel.recorded.on_server_frame(frame);
    if (!is_answer(step)) return;
    const auto at = std::find_if(channel.open.begin(), channel.open.end(), [&](const Request& request) {
      return request.object == *step.object && !request.in_recording;
    });
    if (at != channel.open.end()) at->in_recording = true;
  }
}

void ReplayRun::on_received(const can::Frame& frame) {
  const auto node = node_at(frame, canopen::kSdoAnswer);
  if (node == 0 || frame.extended || frame.error) return;
  auto& channel = channels_[node];
  const auto step = channel.live.on_server_frame(frame);
  if (!is_answer(step)) return;
  const auto at = find_request(channel.open, *step.object);
  const bool write = at != channel.open.end() && at->write;
  if (at != channel.open.end()) channel.open.erase(at);
  if (step.kind == Kind::abort) failures_.push_back({node, *step.object, write, step.abort_code});
}

bool ReplayRun::is_waiting() const {
  return std::any_of(channels_.begin(), channels_.end(),
                     [](const Lane& channel) { return !channel.open.empty(); });
}

void ReplayRun::close() {
  for (std::size_t node = 0; node < channels_.size(); ++node)
    for (const auto& request : std::exchange(channels_[node].open, {})) {
      answered_by_recording_ += request.in_recording;
      if (!request.in_recording)
        failures_.push_back({static_cast<std::uint8_t>(node), request.object, request.write});
    }
}

}  // namespace servoctl::traffic
