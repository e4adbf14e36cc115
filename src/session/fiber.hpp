#pragma once

#include <functional>
#include <memory>

namespace servoctl::session {

/// A function with a stack of its own: it runs until it gives way, and goes on from there when it is resumed.
/// One at a time, in the thread that made it.
class Fiber {
 public:
  /// Does not begin yet. `body` throws nothing, and waits in no handler of an exception. Throws
  /// std::bad_alloc where there is no memory for a stack.
  explicit Fiber(std::function<void()> body);
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;
  /// It has ended, or never begun.
  ~Fiber();

  /// Runs it until it gives way or has ended. Not to be called after that.
  void resume();
  /// Called by what it runs: back to who has resumed it.
  void give_way();

 private:
  struct Stack;
  std::unique_ptr<Stack> stack_;
};

}  // namespace servoctl::session
