#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "session/fiber.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// One thing to be done on a session, written as if it were alone there. Two jobs that run side by side are
/// about different nodes.
using Job = std::function<void()>;

/// Runs several jobs side by side on one session: while one waits for its drive the others go on. Each has a
/// stack of its own in the one thread; a job gives way where it waits (Session::step() and what stands on
/// it), nowhere else.
///
/// What arrives wakes those whom it concerns; a lost bus is told to all that wait, and so is Ctrl-C, but for
/// those that are deaf to it (Deaf). Each job has options of its own, which begin as those of the session,
/// without the callbacks of progress: of that `list_progress` of the session tells how many jobs have ended.
/// What a job throws is thrown by run() when all have ended: the first of them.
class Interleave {
 public:
  /// All outlive it.
  Interleave(Session& session, std::span<const Job> jobs);
  Interleave(const Interleave&) = delete;
  Interleave& operator=(const Interleave&) = delete;

  /// Returns when all jobs have ended. In a job of another one, which has the pump already, they run one
  /// after the other.
  void run();

 private:
  friend class Session;

  struct Lane {
    const Job* job = nullptr;
    Options options;  ///< Its own, while it does not run.
    std::optional<Fiber> fiber;
    TimePoint deadline = kNever;
    const std::function<bool()>* concerns = nullptr;  ///< Null: every arrival does.
    Result<bool> answer = false;
    bool ended = false;
    std::exception_ptr thrown;
  };

  bool in_job() const { return running_ != nullptr; }
  /// In a job: the others go on until something that concerns it has arrived, or the deadline
  /// has passed.
  Result<bool> park(TimePoint deadline, const std::function<bool()>& concerns);

  void start(Lane& lane);
  void give_turn(Lane& lane);
  void guarded(const std::function<void()>& action);
  void pump();
  Result<bool> step_until(TimePoint deadline);
  bool tell_cancelled();
  void serve(const Result<bool>& stepped);
  void resume(Lane& lane, Result<bool> answer);
  TimePoint next_deadline() const;

  Session* session_;
  std::vector<std::unique_ptr<Lane>> lanes_;
  std::size_t open_ = 0;
  bool taken_in_ = false;    ///< A job took in an arrival itself.
  TimePoint seen_{};         ///< Of the last step of the pump.
  Lane* running_ = nullptr;  ///< Null: the pump.
  std::exception_ptr broken_;
};

/// Runs the jobs by an Interleave; a single one as it is.
void run_side_by_side(Session& session, std::span<const Job> jobs);

}  // namespace servoctl::session
