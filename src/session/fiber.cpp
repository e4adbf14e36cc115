#include "session/fiber.hpp"

#include <boost/context/fiber.hpp>
#include <boost/context/protected_fixedsize_stack.hpp>
#include <cstddef>
#include <utility>

#ifndef __has_feature
#define __has_feature(what) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
#include <sanitizer/common_interface_defs.h>
#define SERVOCTL_SANITIZED 1
#else
#define SERVOCTL_SANITIZED 0
#endif

namespace servoctl::session {
namespace {

namespace context = boost::context;

/// Pages that are never touched take no memory.
constexpr std::size_t kStackSize = std::size_t{4} << 20U;

/// Lowest address and bytes of a stack, for the address sanitizer: it has to be told of each switch to
/// another.
using Bounds = std::pair<const void*, std::size_t>;

/// Before the switch to a stack; the answer goes to arrive() when this one goes on.
void* leave_for(const Bounds& other) {
  void* kept = nullptr;
#if SERVOCTL_SANITIZED
  __sanitizer_start_switch_fiber(&kept, other.first, other.second);
#else
  (void)other;
#endif
  return kept;
}

/// Behind the switch; tells where the stack lies that was left.
Bounds arrive(void* kept) {
  Bounds left;
#if SERVOCTL_SANITIZED
  __sanitizer_finish_switch_fiber(kept, &left.first, &left.second);
#else
  (void)kept;
#endif
  return left;
}

}  // namespace

struct Fiber::Stack {
  context::protected_fixedsize_stack memory{kStackSize};
  context::stack_context place = memory.allocate();
  Bounds own{static_cast<const char*>(place.sp) - place.size, place.size};
  Bounds of_caller;
  context::fiber inside, caller;
};

Fiber::Fiber(std::function<void()> body) : stack_(std::make_unique<Stack>()) {
  auto& stack = *stack_;
  const context::preallocated place(stack.place.sp, stack.place.size, stack.place);
  stack.inside = context::fiber(std::allocator_arg, place, stack.memory,
                                [&stack, body = std::move(body)](context::fiber&& caller) {
                                  stack.caller = std::move(caller);
                                  stack.of_caller = arrive(nullptr);
                                  body();
                                  (void)leave_for(stack.of_caller);
                                  return std::move(stack.caller);
                                });
}

Fiber::~Fiber() = default;

void Fiber::resume() {
  auto* kept = leave_for(stack_->own);
  stack_->inside = std::move(stack_->inside).resume();
  (void)arrive(kept);
}

void Fiber::give_way() {
  auto* kept = leave_for(stack_->of_caller);
  stack_->caller = std::move(stack_->caller).resume();
  stack_->of_caller = arrive(kept);
}

}  // namespace servoctl::session
