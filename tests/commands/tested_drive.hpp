#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "command/command.hpp"
#include "command/registry.hpp"
#include "session/wary.hpp"
#include "sim/cell.hpp"
#include "tests/sim/commissioned.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::commands {
using namespace command;

/// A file of this process: tests run beside each other.
inline std::string own_file(std::string_view name) {
  return testing::TempDir() + std::to_string(::getpid()) + "-" + std::string(name);
}

/// A bus that lets a test see and change what a drive says, and act at a time.
class TouchedBus final : public can::Bus {
 public:
  explicit TouchedBus(sim::SimBus& bus) : bus_(&bus) {}
  std::function<void(can::Frame&)> on_receive;  ///< May be empty.
  std::deque<can::Frame> injected;              ///< Of somebody else; they come before what waits.
  std::function<std::uint64_t()> came_of_fd;    ///< May be empty.
  std::uint64_t fd_frames() const override { return came_of_fd ? came_of_fd() : 0; }

  TimePoint now() const override { return bus_->now(); }
  TimePoint next_event() const override { return bus_->next_event(); }
  Result<void> send(const can::Frame& frame) override { return bus_->send(frame); }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    if (!injected.empty()) {
      const auto first = injected.front();
      injected.pop_front();
      return first;
    }
    auto frame = bus_->receive(deadline);
    if (frame && *frame && on_receive) on_receive(**frame);
    return frame;
  }

 private:
  sim::SimBus* bus_;
};

/// Says yes, and remembers what it was asked and shown.
class Onlooker final : public show::Audience {
 public:
  Result<void> confirm(std::string_view question) override {
    questions.emplace_back(question);
    return {};
  }
  void emit(const report::Record& /*sample*/, std::string_view line) override { lines.emplace_back(line); }

  std::vector<std::string> lines;
  std::vector<std::string> questions;
};

/// A command run on simulated drives in virtual time, with its context in the hands of the test.
class TestedDrive : public testing::Test {
 protected:
  void build(const std::string& spec, const std::string& family) {
    const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
    auto built = sim::build_cell(spec, folders, sim_bus.now());
    ASSERT_TRUE(built) << built.error().message.text();
    cell = std::move(*built);
    sim::commission(cell);
    for (const auto& one : cell.drives) sim_bus.attach(*one);
    auto profile = drive::load_profile(family, folders);
    ASSERT_TRUE(profile);
    profile_ = std::move(*profile);
    auto touched = std::make_unique<TouchedBus>(sim_bus);
    bus = touched.get();
    session::Options network;
    network.drive_folders = [] { return std::span<const std::filesystem::path>(kFolders); };
    session = std::make_unique<session::Session>(std::move(touched), "sim:" + spec, std::move(network));
    ASSERT_TRUE(session->listen());
    (void)session->take_events();
    session::be_wary_of_family(*session, 1, profile_);  // As the program does before each command.
    context.session = session.get();
    context.profile = &profile_;
    context.nodes = {1};
    context.keeps_samples = true;
    context.audience = &onlooker_;
  }

  using Words = std::vector<std::pair<std::string, std::string>>;
  Result<report::Value> run(std::string_view command, const Words& words = {}) {
    Arguments arguments;
    for (const auto& [name, value] : words) arguments.add(name, value);
    context.errors.clear();
    return find_command(command)->run(context, arguments);
  }

  /// `failed 2`: verdict and figure of a criterion, as JSON says them; of the last test that has it.
  static std::string criterion(const Result<report::Value>& result, std::string_view id) {
    EXPECT_TRUE(result.has_value());
    if (!result) return result.error().message.text();
    const auto json = *report::parse_json(report::to_json(*result), "result");
    std::string out = "none";
    for (const auto& test : std::get<report::List>(json.data()))
      for (const auto& c : std::get<report::List>(report::find(test, "criteria")->data()))
        if (std::get<std::string>(report::find(c, "id")->data()) == id)
          out = std::get<std::string>(report::find(c, "verdict")->data()) + " " +
                report::to_json(*report::find(c, "figure"));
    return out;
  }
  bool failed() const { return !context.errors.empty() && context.errors.front().code == Errc::negative; }

  sim::SimDrive& drive(std::size_t i = 0) { return *cell.drives[i]; }
  double seconds() const { return std::chrono::duration<double>(sim_bus.now() - begin_).count(); }

  sim::SimBus sim_bus{sim::SimBus::Clock::virtual_time};
  sim::Cell cell;
  TouchedBus* bus = nullptr;
  std::unique_ptr<session::Session> session;
  Context context;

 private:
  Onlooker onlooker_;

 protected:
  std::vector<std::string>& lines = onlooker_.lines;
  std::vector<std::string>& questions = onlooker_.questions;

 private:
  drive::Profile profile_;
  TimePoint begin_ = sim_bus.now();
};

}  // namespace servoctl::commands
