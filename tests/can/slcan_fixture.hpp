#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "can/slcan.hpp"

namespace servoctl::can {

/// An adapter behind a pseudo-terminal: what it answers to each command is scripted.
class ScriptedAdapter {
 public:
  using Script = std::function<std::string(const std::string& command)>;

  /// What a CAN232 says (its manual, version 3).
  static std::string good(const std::string& command) {
    if (command == "V") return "V1013\r";
    if (command == "F") return "F00\r";
    return command.starts_with('t') || command.starts_with('r') ? "z\r" : "\r";
  }

  explicit ScriptedAdapter(Script script = good) : script_(std::move(script)) {
    int master = -1;
    int slave = -1;
    char name[64];
    EXPECT_EQ(::openpty(&master, &slave, name, nullptr, nullptr), 0);
    termios settings{};
    ::tcgetattr(slave, &settings);
    ::cfmakeraw(&settings);
    ::tcsetattr(slave, TCSANOW, &settings);
    master_ = Descriptor(master);
    held_ = Descriptor(slave);
    path_ = name;
    worker_ = std::thread([this] { work(); });
  }
  ~ScriptedAdapter() { stop(); }

  const std::string& path() const { return path_; }
  std::string place() const { return path_ + "@500k"; }

  void say(std::string_view text) {
    const std::lock_guard lock(mutex_);
    EXPECT_EQ(::write(master_.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  void set_script(Script script) {
    const std::lock_guard lock(mutex_);
    script_ = std::move(script);
  }

  void unplug() {
    stop();
    held_ = Descriptor();
    Descriptor gone = std::move(master_);
  }

  std::vector<std::string> heard() {
    const std::lock_guard lock(mutex_);
    return heard_;
  }
  /// Whether it hears this command within two seconds.
  bool hears(const std::string& command) {
    for (int i = 0; i < 2000; ++i, nap(std::chrono::milliseconds(1)))
      for (const auto& word : heard())
        if (word == command) return true;
    return false;
  }

 private:
  void stop() {
    ends_ = true;
    if (worker_.joinable()) worker_.join();
  }

  void work() {
    std::string pending;
    while (!ends_) {
      pollfd entry{master_.get(), POLLIN, 0};
      if (::poll(&entry, 1, 5) <= 0) continue;
      char bytes[256];
      const auto count = ::read(master_.get(), bytes, sizeof bytes);
      if (count <= 0) continue;
      pending.append(bytes, static_cast<std::size_t>(count));
      for (auto end = pending.find('\r'); end != std::string::npos; end = pending.find('\r')) {
        on_command(pending.substr(0, end));
        pending.erase(0, end + 1);
      }
    }
  }

  void on_command(const std::string& command) {
    const std::lock_guard lock(mutex_);
    heard_.push_back(command);
    const auto answer = script_(command);
    EXPECT_EQ(::write(master_.get(), answer.data(), answer.size()), static_cast<ssize_t>(answer.size()));
  }

  std::mutex mutex_;
  Script script_;
  Descriptor master_;
  Descriptor held_;  ///< So that the port stays when a program closes it.
  std::string path_;
  std::vector<std::string> heard_;
  std::atomic<bool> ends_ = false;
  std::thread worker_;
};

inline Frame slcan_frame(const char* text) { return parse_frame(text).value(); }

/// Null where it is not opened, which fails the test.
inline std::unique_ptr<Bus> open_at(const ScriptedAdapter& adapter) {
  auto bus = open_slcan(adapter.place());
  EXPECT_TRUE(bus) << bus.error().message.text();
  return bus ? std::move(*bus) : nullptr;
}

/// What comes within two seconds.
inline std::optional<Frame> next_frame(Bus& bus) {
  const auto frame = bus.receive(bus.now() + std::chrono::seconds(2));
  EXPECT_TRUE(frame) << frame.error().message.text();
  return frame ? *frame : std::nullopt;
}

}  // namespace servoctl::can
