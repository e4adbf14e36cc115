#include "motion/dialogue.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "canopen/cob_id.hpp"

namespace servoctl::motion {
namespace {

/// What receive() may tell beside frames, such as a trace that cannot be written, is told once each.
constexpr int kMostRemarks = 100;

class DialogueRun {
 public:
  DialogueRun(session::Session& session, std::span<Dialogue* const> dialogues) : session_(&session) {
    for (auto* dialogue : dialogues)
      channels_.push_back({dialogue, canopen::SdoClient(dialogue->node(), session.options().timeout),
                           TimePoint::min(), false});
  }

  void run(const std::function<bool(const Error&)>& bus_back) {
    for (;;) {
      const auto went = round();
      if (went && open_ == 0) return;
      if (went) continue;
      if (went.error().code != Errc::bus && ++remarks_ < kMostRemarks) continue;
      if (went.error().code == Errc::bus && bus_back(went.error()))
        restart();
      else
        return end(went.error());
    }
  }

 private:
  struct Channel {
    Dialogue* dialogue;
    canopen::SdoClient client;
    TimePoint pause;
    bool done;
  };

  /// Sends what is to be sent, and receives one frame.
  Result<void> round() {
    auto next = kNever;
    open_ = 0;
    for (auto& channel : channels_) {
      if (channel.done) continue;
      if (const auto went = advance(channel); !went) return went;
      if (channel.done) continue;
      ++open_;
      next = std::min(next, channel.client.busy() ? channel.client.deadline() : channel.pause);
    }
    if (open_ == 0) return {};
    const auto frame = session_->receive(next);
    if (!frame) return tl::unexpected<Error>(frame.error());
    const auto now = session_->received_at();
    for (auto& channel : channels_) {
      if (*frame && is_for(**frame, channel)) channel.client.on_frame(**frame, now);
      if (channel.client.deadline() <= now) channel.client.on_time(now);
    }
    return {};
  }

  static bool is_for(const can::Frame& frame, const Channel& channel) {
    return frame.id >= canopen::kSdoAnswer && frame.id <= canopen::kErrorControl + canopen::kLastNode &&
           (frame.id & 0x7FU) == channel.dialogue->node();
  }

  /// Until it waits for an answer or the time.
  Result<void> advance(Channel& channel) {
    for (;;) {
      if (const auto frame = channel.client.take_frame()) {
        if (auto sent = session_->send(*frame); !sent) return sent;
        continue;
      }
      if (auto result = channel.client.take_result()) {
        if (*result) lost_in_a_row_ = 0;
        channel.dialogue->on_answer(std::move(*result), session_->now());
        continue;
      }
      if (channel.client.busy() || session_->now() < channel.pause) return {};
      auto step = channel.dialogue->next(session_->now());
      channel.done = step.done;
      if (step.done) return {};
      if (step.nmt)
        if (auto sent = session_->send(canopen::nmt_frame(*step.nmt, channel.dialogue->node())); !sent)
          return sent;
      if (step.request) start(channel, std::move(*step.request));
      channel.pause = step.pause;
    }
  }

  void start(Channel& channel, session::SdoRequest request) {
    if (request.data)
      channel.client.start_download(request.object, std::move(*request.data), session_->now());
    else
      channel.client.start_upload(request.object, session_->now());
  }

  void restart() {
    if (std::exchange(lost_in_a_row_, lost_in_a_row_ + 1) > 0) say_last_words();
    for (auto& channel : channels_) {
      if (channel.done) continue;
      channel.client = canopen::SdoClient(channel.dialogue->node(), session_->options().timeout);
      channel.pause = TimePoint::min();
      channel.dialogue->on_bus_back();
    }
  }

  /// A bus may carry a frame and say that it did not.
  void say_last_words() {
    for (const auto& channel : channels_) {
      auto word = channel.done ? std::nullopt : channel.dialogue->last_word();
      if (!word) continue;
      canopen::SdoClient client(channel.dialogue->node(), session_->options().timeout);
      client.start_download(word->object, std::move(*word->data), session_->now());
      if (const auto frame = client.take_frame()) (void)session_->send(*frame);
    }
  }

  void end(const Error& error) {
    say_last_words();
    for (auto& channel : channels_)
      if (!channel.done) channel.dialogue->on_end(error);
  }

  session::Session* session_;
  std::vector<Channel> channels_;
  std::size_t open_ = 0;
  int remarks_ = 0;
  int lost_in_a_row_ = 0;  ///< Without an answer in between.
};

}  // namespace

void hold_all(session::Session& session, std::span<Dialogue* const> dialogues,
              const std::function<bool(const Error& lost)>& bus_back) {
  DialogueRun(session, dialogues).run(bus_back);
}

}  // namespace servoctl::motion
