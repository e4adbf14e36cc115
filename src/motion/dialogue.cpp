#include "motion/dialogue.hpp"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "session/wary.hpp"

namespace servoctl::motion {
namespace {

/// What a step may tell beside arrivals, such as a trace that cannot be written, is told once each.
constexpr int kMostRemarks = 100;

class DialogueRun {
 public:
  DialogueRun(session::Session& session, std::span<Dialogue* const> dialogues) : session_(&session) {
    for (auto* dialogue : dialogues)
      channels_.push_back({dialogue, new_channel(dialogue->node()), TimePoint::min(), false});
    signals_ = signals();
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
  struct Lane {
    Dialogue* dialogue;
    std::unique_ptr<session::ObjectChannel> objects;
    TimePoint pause;
    bool done;
    session::SdoRequest request = {};  ///< That is under way.
    TimePoint begun = {};
    bool hastens = false;  ///< A signal came that it was not told of.
  };

  unsigned signals() const { return session_->options().signals ? session_->options().signals() : 0; }

  /// The signal that ended a motion is not counted: it came before.
  void hear_signals() {
    const auto before = std::exchange(signals_, signals());
    if (before == signals_) return;
    for (auto& channel : channels_) {
      channel.hastens = true;
      channel.pause = TimePoint::min();
    }
    if (session_->options().tell)
      session_->options().tell(
          "signal received: the drives are still being stopped; servoctl ends after that");
  }

  std::unique_ptr<session::ObjectChannel> new_channel(std::uint8_t node) {
    return session_->network().object_channel(node, session_->options().timeout);
  }

  /// Sends what is to be sent, and takes in one arrival.
  Result<void> round() {
    auto next = kNever;
    open_ = 0;
    hear_signals();
    for (auto& channel : channels_) {
      if (channel.done) continue;
      if (const auto went = advance(channel); !went) return went;
      if (channel.done) continue;
      ++open_;
      next = std::min(next, channel.objects->busy() ? channel.objects->deadline() : channel.pause);
    }
    if (open_ == 0) return {};
    if (const auto stepped = session_->step(next); !stepped) return fail(stepped.error());
    return {};
  }

  /// Until it waits for an answer or the time.
  Result<void> advance(Lane& channel) {
    for (;;) {
      if (auto sent = channel.objects->on_time(session_->received_at()); !sent) return sent;
      if (auto result = channel.objects->take_result()) {
        if (is_doubtful(channel, *result)) *result = Bytes{};
        if (*result) lost_in_a_row_ = 0;
        tell(channel, *result);
        channel.dialogue->on_answer(std::move(*result), session_->now());
        continue;
      }
      if (channel.objects->busy() || session_->now() < channel.pause) return {};
      if (std::exchange(channel.hastens, false)) channel.dialogue->hasten(session_->now());
      auto step = channel.dialogue->next(session_->now());
      channel.done = step.done;
      if (step.done) return {};
      if (step.state)
        if (auto sent = session_->network().request_state(channel.dialogue->node(), *step.state); !sent)
          return sent;
      if (step.request) start(channel, std::move(*step.request));
      channel.pause = step.pause;
    }
  }

  /// The drive has acknowledged this write, or an earlier one of the same object: it is not silent, and what
  /// is read next shows what it did.
  bool is_doubtful(const Lane& channel, const Result<Bytes>& result) const {
    return !result && result.error().code == Errc::timeout && channel.request.data &&
           session_->now() < channel.begun + session_->options().timeout;
  }

  void tell(const Lane& channel, const Result<Bytes>& result) const {
    const auto& request = channel.request;
    if (const auto& exchanged = session_->options().exchanged)
      exchanged({*session_, channel.dialogue->node(), request.object, request.data ? &*request.data : nullptr,
                 result, channel.begun, result ? session_->received_at() : session_->network().stepped_at()});
  }

  void start(Lane& channel, session::SdoRequest asked) {
    const auto& request = channel.request = std::move(asked);
    channel.begun = session_->now();
    if (auto refusal = session::refusal_of(*session_, channel.dialogue->node(), request.object))
      return channel.dialogue->on_answer(fail(std::move(*refusal)), channel.begun);
    if (request.data)
      channel.objects->start_download(request.object, *request.data, channel.begun, request.transfer);
    else
      channel.objects->start_upload(request.object, channel.begun, request.transfer, request.size);
  }

  void restart() {
    if (std::exchange(lost_in_a_row_, lost_in_a_row_ + 1) > 0) say_last_words();
    for (auto& channel : channels_) {
      if (channel.done) continue;
      channel.objects = new_channel(channel.dialogue->node());
      channel.pause = TimePoint::min();
      channel.dialogue->on_bus_back();
    }
  }

  /// A bus may carry a frame and say that it did not.
  void say_last_words() {
    for (const auto& channel : channels_) {
      auto word = channel.done ? std::nullopt : channel.dialogue->last_word();
      if (!word) continue;
      const auto objects = new_channel(channel.dialogue->node());
      objects->start_download(word->object, std::move(*word->data), session_->now(), word->transfer);
      (void)objects->on_time(session_->received_at());
    }
  }

  void end(const Error& error) {
    say_last_words();
    for (auto& channel : channels_)
      if (!channel.done) channel.dialogue->on_end(error);
  }

  session::Session* session_;
  std::vector<Lane> channels_;
  std::size_t open_ = 0;
  int remarks_ = 0;
  unsigned signals_ = 0;   ///< That were heard.
  int lost_in_a_row_ = 0;  ///< Without an answer in between.
};

}  // namespace

void hold_all(session::Session& session, std::span<Dialogue* const> dialogues,
              const std::function<bool(const Error& lost)>& bus_back) {
  DialogueRun(session, dialogues).run(bus_back);
}

}  // namespace servoctl::motion
