#pragma once

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <string_view>

#include "can/bus.hpp"
#include "sim/cell.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {

/// A simulated bus that several masters share, each in a thread of its own, in one virtual time: it moves on
/// when all of them wait. All join before the first one waits.
class SharedWire {
 public:
  explicit SharedWire(std::string_view spec) {
    const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
    cell = sim::build_cell(spec, folders, now_).value();
    run_devices();
  }

  class Member final : public can::Bus {
   public:
    explicit Member(SharedWire& wire) : wire_(&wire) { wire.members_.push_back(this); }
    ~Member() override { leave(); }

    TimePoint now() const override {
      const std::lock_guard lock(wire_->mutex_);
      return wire_->now_;
    }
    Result<void> send(const can::Frame& frame) override {
      const std::lock_guard lock(wire_->mutex_);
      if (!dead) wire_->deliver(frame, this, nullptr);
      return {};
    }
    Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
      std::unique_lock lock(wire_->mutex_);
      for (;;) {
        if (!inbox_.empty() && !dead) {
          const std::optional<can::Frame> frame = inbox_.front();
          inbox_.pop_front();
          return frame;
        }
        inbox_.clear();
        if (wire_->now_ >= deadline) return std::optional<can::Frame>();
        wake_ = deadline;
        waits_ = true;
        if (!wire_->move_on()) wire_->changed_.wait(lock);
        waits_ = false;
      }
    }

    /// The process was killed: nothing of it reaches the bus any more.
    bool dead = false;

   private:
    friend class SharedWire;
    void leave() {
      const std::lock_guard lock(wire_->mutex_);
      wire_->members_.remove(this);
      (void)wire_->move_on();
    }
    SharedWire* wire_;
    std::deque<can::Frame> inbox_;
    TimePoint wake_{};
    bool waits_ = false;
  };

  sim::Cell cell;

 private:
  void deliver(const can::Frame& frame, const Member* sender, const sim::Device* device) {
    for (const auto& drive : cell.drives)
      if (drive.get() != device) drive->on_frame(frame, now_);
    for (auto* member : members_)
      if (member != sender) member->inbox_.push_back(frame);
    collect();
    changed_.notify_all();
  }
  void collect() {
    for (const auto& drive : cell.drives)
      while (const auto frame = drive->take_frame()) deliver(*frame, nullptr, drive.get());
  }
  void run_devices() {
    for (const auto& drive : cell.drives)
      if (drive->deadline() <= now_) drive->on_time(now_);
    collect();
  }
  /// False while somebody has something to do at this time.
  bool move_on() {
    for (const auto* member : members_)
      if (!member->waits_ || !member->inbox_.empty()) return false;
    if (members_.empty()) return false;
    auto next = kNever;
    for (const auto* member : members_) next = std::min(next, member->wake_);
    for (const auto& drive : cell.drives) next = std::min(next, drive->deadline());
    now_ = std::max(now_, next);
    // Whoever is woken by it is no longer waiting.
    for (auto* member : members_) member->waits_ = member->wake_ > now_;
    run_devices();
    for (auto* member : members_) member->waits_ = member->waits_ && member->inbox_.empty();
    changed_.notify_all();
    return true;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  TimePoint now_{std::chrono::seconds(1)};
  std::list<Member*> members_;
};

}  // namespace servoctl::session
