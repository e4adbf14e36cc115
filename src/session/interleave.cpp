#include "session/interleave.hpp"

#include <algorithm>
#include <utility>

namespace servoctl::session {
namespace {

/// As that of Session::step(): whoever cancels by a simulated clock is asked so often.
constexpr Duration kLongestStep = std::chrono::milliseconds(250);

}  // namespace

Interleave::Interleave(Session& session, std::span<const Job> jobs) : session_(&session) {
  for (const auto& job : jobs) {
    auto& lane = *lanes_.emplace_back(std::make_unique<Lane>());
    lane.job = &job;
    lane.options = session.options();
    lane.options.progress = {};
    lane.options.list_progress = {};
  }
}

void Interleave::run() {
  if (session_->interleave_ != nullptr) {
    for (const auto& lane : lanes_) (*lane->job)();
    return;
  }
  session_->interleave_ = this;
  // Whether a wait is cancelled is asked for each job on its own.
  auto cancelled = std::exchange(session_->options().cancelled, {});
  open_ = lanes_.size();
  for (const auto& lane : lanes_) guarded([&] { start(*lane); });
  while (open_ > 0) guarded([this] { pump(); });
  session_->options().cancelled = std::move(cancelled);
  session_->interleave_ = nullptr;
  for (const auto& lane : lanes_)
    if (lane->thrown) std::rethrow_exception(lane->thrown);
  if (broken_) std::rethrow_exception(broken_);
}

void Interleave::start(Lane& lane) {
  const auto body = [&lane] {
    try {
      (*lane.job)();
    } catch (...) {
      lane.thrown = std::current_exception();
    }
    lane.ended = true;
  };
  try {
    lane.fiber.emplace(body);
  } catch (...) {
    lane.thrown = std::current_exception();
    lane.ended = true;
    --open_;
    return;
  }
  give_turn(lane);
}

/// Lets a job run until it waits or has ended.
void Interleave::give_turn(Lane& lane) {
  std::swap(session_->options_, lane.options);
  running_ = &lane;
  lane.fiber->resume();
  running_ = nullptr;
  std::swap(session_->options_, lane.options);
  if (!lane.ended) return;
  --open_;
  if (const auto& tell = session_->options().list_progress)
    tell(lanes_.size() - open_, lanes_.size(), session_->received_at());
}

Result<bool> Interleave::park(TimePoint deadline, const std::function<bool()>& concerns) {
  auto& lane = *running_;
  lane.deadline = deadline;
  lane.concerns = concerns ? &concerns : nullptr;
  lane.fiber->give_way();
  return std::move(lane.answer);
}

/// What is thrown outside of the jobs is the end of the bus for all of them: each goes its way out, and none
/// is left where it waits.
void Interleave::guarded(const std::function<void()>& action) {
  try {
    action();
  } catch (...) {
    if (!broken_) broken_ = std::current_exception();
  }
}

void Interleave::pump() {
  if (!broken_ && tell_cancelled()) return;
  const auto before = session_->network().stepped_at();
  // What a job took in itself may have been for another one, which nobody has asked since.
  const bool restless = std::exchange(taken_in_, false) || before != seen_;
  const auto stepped = step_until(restless ? session_->received_at() : next_deadline());
  seen_ = session_->network().stepped_at();
  serve(stepped);
}

TimePoint Interleave::next_deadline() const {
  auto next = kNever;
  for (const auto& lane : lanes_)
    if (!lane->ended) next = std::min(next, lane->deadline);
  return next;
}

Result<bool> Interleave::step_until(TimePoint deadline) {
  if (broken_) return fail(Errc::bus, "the bus cannot be listened to any more");
  return session_->step_network(std::min(deadline, session_->received_at() + kLongestStep));
}

/// Those that hear Ctrl-C; false when none did.
bool Interleave::tell_cancelled() {
  bool any = false;
  for (const auto& lane : lanes_) {
    if (lane->ended || !lane->options.cancelled || !lane->options.cancelled()) continue;
    resume(*lane, fail(Errc::interrupted, "interrupted"));
    any = true;
  }
  return any;
}

void Interleave::serve(const Result<bool>& stepped) {
  for (const auto& lane : lanes_) {
    if (lane->ended) continue;
    const bool due = lane->deadline <= session_->received_at();
    if (!stepped || due || lane->concerns == nullptr || (*lane->concerns)()) resume(*lane, stepped);
  }
}

void Interleave::resume(Lane& lane, Result<bool> answer) {
  lane.answer = std::move(answer);
  lane.concerns = nullptr;
  give_turn(lane);
}

void run_side_by_side(Session& session, std::span<const Job> jobs) {
  if (jobs.size() == 1) return jobs.front()();
  Interleave(session, jobs).run();
}

}  // namespace servoctl::session
