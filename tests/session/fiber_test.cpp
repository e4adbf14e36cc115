#include "session/fiber.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>

namespace servoctl::session {
namespace {

TEST(Fiber, GoesOnFromWhereItGaveWay) {
  std::string order;
  std::unique_ptr<Fiber> one;
  std::unique_ptr<Fiber> other;
  one = std::make_unique<Fiber>([&] {
    order += "1";
    one->give_way();
    order += "3";
  });
  other = std::make_unique<Fiber>([&] {
    order += "2";
    other->give_way();
    order += "4";
  });
  one->resume();
  other->resume();
  one->resume();
  other->resume();
  EXPECT_EQ(order, "1234");
}

/// What an exception passes may wait: another one is thrown and caught meanwhile.
TEST(Fiber, WaitsWhileAnExceptionPasses) {
  std::unique_ptr<Fiber> waiting;
  struct Waits {
    Fiber* fiber;
    ~Waits() { fiber->give_way(); }
  };
  std::string caught;
  waiting = std::make_unique<Fiber>([&] {
    try {
      const Waits waits{waiting.get()};
      throw std::out_of_range("first");
    } catch (const std::exception& e) {
      caught += e.what();
    }
  });
  Fiber other([&] {
    try {
      throw std::runtime_error("second ");
    } catch (const std::exception& e) {
      caught += e.what();
    }
  });
  waiting->resume();
  other.resume();
  waiting->resume();
  EXPECT_EQ(caught, "second first");
}

int depth_of(int left) {
  volatile char page[4096] = {};
  page[left % 4096] = 1;
  return left == 0 ? page[0] : depth_of(left - 1) + page[left % 4096];
}

TEST(Fiber, HasRoomForDeepCalls) {
  int depth = 0;
  Fiber fiber([&] { depth = depth_of(500); });
  fiber.resume();
  EXPECT_EQ(depth, 501);
}

}  // namespace
}  // namespace servoctl::session
