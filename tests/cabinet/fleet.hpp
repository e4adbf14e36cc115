#pragma once

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cabinet/apply.hpp"
#include "fleet_bus.hpp"
#include "session/can_network.hpp"
#include "settings/restore_journal.hpp"
#include "sim/sim_drive.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

/// A cabinet of simulated drives, on buses in this process.
namespace servoctl::cabinet {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

inline const std::vector<fs::path>& drive_data() {
  static const std::vector<fs::path> all{fs::path(source_dir()) / "eds"};
  return all;
}

inline const drive::Profile& family_of(const std::string& family) {
  static std::map<std::string, drive::Profile> all;
  const auto found = all.find(family);
  return found != all.end()
             ? found->second
             : all.emplace(family, drive::load_profile(family, drive_data()).value()).first->second;
}

/// What the axes of a family are to hold: parameters and objects that a restart does and does not forget.
inline const std::map<std::string, std::vector<std::pair<std::string, std::string>>>& wishes() {
  static const std::map<std::string, std::vector<std::pair<std::string, std::string>>> all{
      {"gsd600",
       {{"Pn0214", "45Hz"}, {"Pn0202", "321"}, {"Pn0032", "1"}, {"0x605A", "1"}, {"0x6065", "65536"}}},
      {"da200", {{"P5.12", "77"}, {"0x6065", "5000"}, {"0x6083", "3000"}}},
      {"dm", {{"0x6083", "3000"}, {"0x6084", "4000"}, {"0x6065", "5000"}}},
      {"sv2", {{"0x2001:1", "60"}, {"0x2001:2", "90"}, {"0x6083", "3000"}}},
      {"ts", {{"Fn_33", "120"}, {"Fn_3A", "3"}, {"Fn_12E", "50"}}},
  };
  return all;
}

/// Drives of all families in turn, on some buses, with the cabinet file that tells of them.
class Fleet {
 public:
  explicit Fleet(std::size_t axes, std::size_t buses = 1, Duration delay = {})
      : folder_(fs::temp_directory_path() / fmt::format("servoctl-fleet-{}-{}", ::getpid(), next_++)) {
    desk.audience = &willing;
    fs::create_directories(folder_);
    cabinet.file = folder_ / "cabinet.toml";
    for (std::size_t i = 0; i < buses; ++i) {
      cabinet.buses.push_back({fmt::format("bus{}", i), fmt::format("sim:{}", i), {}, {}});
      lines_.emplace_back();
    }
    auto family = wishes().begin();
    for (std::size_t i = 0; i < axes; ++i) {
      add_axis(family->first, i, i % buses, delay);
      if (++family == wishes().end()) family = wishes().begin();
    }
    for (auto& line : lines_) {
      open(line, {});
      (void)line.session->wait([] { return false; }, line.session->now() + 1s);
    }
    (void)session(0);
  }
  ~Fleet() {
    for (auto& line : lines_) {
      line.bus = nullptr;
      line.session.reset();
    }
    fs::remove_all(folder_);
  }
  Fleet(const Fleet&) = delete;
  Fleet& operator=(const Fleet&) = delete;

  /// From now on the buses are in such trouble; with {} all is well, and silent drives are back.
  void trouble(const BusTrouble& trouble, std::size_t bus = 0) {
    heal();
    std::size_t i = 0;
    for (auto& line : lines_) open(line, i++ == bus ? trouble : BusTrouble{});
  }
  void heal() {
    for (auto& drive : drives_) drive->wire_faults().silent = false;
    for (auto& line : lines_) {
      open(line, {});
      (void)line.session->wait([] { return false; }, line.session->now() + 2s);
    }
  }

  /// From now on the buses are opened by this URL, as far as anybody can tell.
  void call_buses(std::string url) {
    url_ = std::move(url);
    heal();
  }

  std::vector<Station> stations() {
    std::vector<Station> out;
    for (const auto& axis : cabinet.axes)
      out.push_back({&axis, &family_of(axis.family), line_of(axis).session.get()});
    return out;
  }
  session::Session& session(std::size_t axis) { return *line_of(cabinet.axes[axis]).session; }
  sim::SimDrive& drive(std::size_t axis) { return *drives_[axis]; }
  /// Each axis is to have a heartbeat and PDOs of its own as well, as far as its family has such.
  void give_pdos_and_heartbeats() {
    for (auto& axis : cabinet.axes) {
      axis.heartbeat_at = axis.at;
      if (family_of(axis.family).dictionary.find({0x1017, 0}) != nullptr) axis.heartbeat = 500ms;
      const auto& presets = family_of(axis.family).rules.pdo.presets;
      if (!presets.empty()) axis.pdos.preset = presets.back().name;
      drive::PdoRecipe recipe;
      recipe.pdo = "TPDO1";
      recipe.type = 1;
      recipe.valid = true;
      if (presets.empty()) axis.pdos.recipes = {recipe};
      axis.pdos.at = axis.at;
    }
  }
  std::size_t size() const { return drives_.size(); }
  int requests(std::size_t bus = 0) const {
    return std::next(lines_.begin(), static_cast<long>(bus))->bus->requests;
  }

  std::vector<PlannedAxis> look(const PlanChoice& choice = {.unlisted = false}) {
    return look_at_all(desk, cabinet, stations(), choice);
  }
  /// Values that differ, of all axes; an error is a failure of the test.
  std::size_t different(const PlanChoice& choice = {.unlisted = false}) {
    std::size_t out = 0;
    for (const auto& look : look(choice)) {
      EXPECT_TRUE(look.plan) << look.axis->name << " (" << look.axis->family
                             << "): " << look.plan.error().message.text();
      if (look.plan) out += look.plan->different;
    }
    return out;
  }
  Result<report::Value> apply(const ApplyOptions& options = {}) { return apply(stations(), options); }
  Result<report::Value> apply(const std::vector<Station>& at, ApplyOptions options) {
    options.choice.unlisted = false;
    desk.errors.clear();
    desk.notices.clear();
    return apply_cabinet(desk, cabinet, at, options);
  }
  /// What the answer says of an axis.
  static std::string result_of(const report::Value& answer, std::size_t axis) {
    const auto& table = *answer.table();
    return std::get<std::string>(table.rows.at(axis).at(4).data());
  }
  static std::vector<std::string> results_of(const report::Value& answer) {
    std::vector<std::string> out;
    for (std::size_t i = 0; i < answer.table()->rows.size(); ++i) out.push_back(result_of(answer, i));
    return out;
  }
  /// What an axis holds of what the file says, past the bus.
  session::Values held(std::size_t axis, const session::Values& of) {
    session::Values out;
    for (const auto& value : of) out.emplace(value.first, drives_[axis]->value(value.first));
    return out;
  }
  void power_cycle() { command("8100"); }
  void start_all() { command("0100"); }
  /// An NMT command to all nodes.
  void command(std::string_view data) {
    for (auto& line : lines_) {
      (void)line.session->can()->send(*can::parse_frame(fmt::format("000#{}", data)));
      (void)line.session->wait([] { return false; }, line.session->now() + 2s);
    }
  }
  const fs::path& folder() const { return folder_; }

  Cabinet cabinet;
  show::Willing willing;
  show::Desk desk;

 private:
  struct Line {
    std::unique_ptr<sim::SimBus> wire = std::make_unique<sim::SimBus>(sim::SimBus::Clock::virtual_time);
    sim::Memory memory;
    std::map<std::uint8_t, sim::SimDrive*> drives;
    FleetBus* bus = nullptr;
    std::unique_ptr<session::Session> session;
  };

  void add_axis(const std::string& family, std::size_t number, std::size_t bus, Duration delay) {
    Axis axis;
    axis.name = fmt::format("axis{}", number + 1);
    axis.bus = cabinet.buses[bus].name;
    axis.node = static_cast<std::uint8_t>(number / cabinet.buses.size() + 1);
    axis.family = family;
    axis.at = {static_cast<std::uint32_t>(number * 10 + 1), 1};
    std::uint32_t line = axis.at.line;
    for (const auto& [name, value] : wishes().at(family))
      axis.parameters.push_back({name, value, {++line, 1}});
    auto& place = *std::next(lines_.begin(), static_cast<long>(bus));
    drives_.push_back(std::make_unique<sim::SimDrive>(family_of(family), axis.node, place.memory,
                                                      fmt::format("{}", number)));
    drives_.back()->wire_faults().answer_delay = delay;
    place.wire->attach(*drives_.back());
    place.drives.emplace(axis.node, drives_.back().get());
    cabinet.axes.push_back(std::move(axis));
  }
  void open(Line& line, const BusTrouble& trouble) {
    line.bus = nullptr;
    line.session.reset();
    auto bus = std::make_unique<FleetBus>(*line.wire, line.drives, trouble);
    line.bus = bus.get();
    session::Options options;
    options.drive_folders = [] { return std::span<const fs::path>(drive_data()); };
    options.timeout = 50ms;  // A simulated drive answers soon or never.
    options.cancelled = [this] {
      return std::any_of(lines_.begin(), lines_.end(),
                         [](const Line& each) { return each.bus != nullptr && each.bus->is_cancelled(); });
    };
    line.session = std::make_unique<session::Session>(std::move(bus), url_, std::move(options));
  }
  Line& line_of(const Axis& axis) {
    auto line = lines_.begin();
    for (const auto& bus : cabinet.buses) {
      if (bus.name == axis.bus) return *line;
      ++line;
    }
    return lines_.front();
  }

  static inline int next_ = 0;
  std::string url_ = "sim:";
  fs::path folder_;
  std::list<Line> lines_;
  std::vector<std::unique_ptr<sim::SimDrive>> drives_;
};

}  // namespace servoctl::cabinet
