#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "base/file.hpp"
#include "can/trace.hpp"

namespace servoctl::can {

/// A bus in virtual time: gives what the test put in, each at its time, and lets time pass while it waits.
class ScriptedBus final : public Bus {
 public:
  explicit ScriptedBus(TimePoint start) : now_(start) {}
  ScriptedBus(const ScriptedBus&) = delete;
  ScriptedBus& operator=(const ScriptedBus&) = delete;
  ~ScriptedBus() override {
    if (left != nullptr) *left = true;
  }

  TimePoint now() const override { return now_; }
  Result<void> send(const Frame&) override {
    if (broken) return fail(Errc::bus, "can0 went down");
    return {};
  }
  Result<std::optional<Frame>> receive(TimePoint deadline) override {
    deadlines.push_back(deadline);
    if (broken) return fail(Errc::bus, "can0 went down");
    if (interrupted) return std::optional<Frame>();
    if (!coming.empty() && coming.front().first <= std::max(deadline, now_)) {
      const auto [time, frame] = coming.front();
      coming.pop_front();
      now_ = std::max(now_, time);
      return frame;
    }
    now_ = std::max(now_, deadline);
    return std::optional<Frame>();
  }
  int poll_fd() const override { return 77; }
  TimePoint next_event() const override { return next; }

  std::deque<std::pair<TimePoint, Frame>> coming;
  std::vector<TimePoint> deadlines;  ///< Of every receive().
  TimePoint next = kNever;
  bool broken = false;
  bool interrupted = false;
  bool* left = nullptr;  ///< Told when nobody is on the bus any more.

 private:
  TimePoint now_;
};

class Trace : public testing::Test {
 protected:
  Trace() {
    std::string name = testing::TempDir() + "servoctl-trace-XXXXXX";
    ::close(::mkstemp(name.data()));
    file_ = name;
  }
  ~Trace() override { std::filesystem::remove(file_); }

  std::unique_ptr<Bus> trace(TimePoint start, TraceClock clock = TraceClock::bus) {
    auto inner = std::make_unique<ScriptedBus>(start);
    inner_ = inner.get();
    return trace_to(std::move(inner), file_, "can0", clock).value();
  }
  std::string written() const { return read_file(file_).value(); }

  std::ptrdiff_t lines() const {
    const auto text = written();
    return std::count(text.begin(), text.end(), '\n');
  }

  std::filesystem::path file_;
  ScriptedBus* inner_ = nullptr;
};

}  // namespace servoctl::can
