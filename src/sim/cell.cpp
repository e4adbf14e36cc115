#include "sim/cell.hpp"

#include <utility>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "canopen/lss.hpp"
#include "sim/cell_spec.hpp"

namespace servoctl::sim {
namespace {

constexpr std::string_view kExample =
    "simulated drives are written sim:FAMILY@NODE, for example sim:gsd600@1,gsd600@2?state=FILE";

/// With serial numbers that differ: it is by them that LSS tells drives of one kind apart.
void enable_lss(const std::vector<std::unique_ptr<SimDrive>>& drives) {
  std::uint32_t serial = 0;
  for (const auto& drive : drives) drive->enable_lss(++serial);
}

Result<void> apply_option(const CellSpec& spec, const CellSpec::Option& option,
                          const std::vector<std::unique_ptr<SimDrive>>& drives, TimePoint now) {
  if (option.key == "state") return {};
  std::vector<DriveModel*> models;
  for (const auto& drive : drives) models.push_back(&drive->model());
  const auto is_applied = apply_drive_option(spec, option, models, now);
  if (!is_applied) return fail(is_applied.error());
  if (*is_applied) return {};
  if (option.key == "lss") {
    enable_lss(drives);
    return {};
  }
  if (option.key == "lie") {
    const auto words = lies_of(spec, option, kCanLies);
    if (!words) return fail(words.error());
    for (const auto& drive : drives)
      for (const auto word : *words) add_lie(drive->wire_faults(), word);
    return {};
  }
  if (option.key != "silent" && option.key != "delay") {
    const std::string keys[] = {"state", "fault", "silent", "delay", "lie", "counts", "panel", "lss"};
    return spec.wrong(
        message("'{}' is not an option of a simulated bus: use {}", as_it_is(option.key), one_of(keys)));
  }
  const auto time = time_of(spec, option);
  if (!time) return fail(time.error());
  for (const auto& drive : drives) {
    if (option.key == "silent") drive->fall_silent_at(now + *time);
    if (option.key == "delay") drive->wire_faults().answer_delay = *time;
  }
  return {};
}

/// A simulated bus that owns what is on it.
class CellBus final : public can::Bus {
 public:
  CellBus(Cell cell, SimBus::Clock clock) : cell_(std::move(cell)), bus_(clock) {
    for (const auto& drive : cell_.drives) bus_.attach(*drive);
  }
  TimePoint now() const override { return bus_.now(); }
  Result<void> send(const can::Frame& frame) override { return bus_.send(frame); }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override { return bus_.receive(deadline); }
  TimePoint next_event() const override { return bus_.next_event(); }

 private:
  Cell cell_;
  SimBus bus_;
};

}  // namespace

Result<Cell> build_cell(std::string_view text, std::span<const std::filesystem::path> folders,
                        TimePoint now) {
  const auto spec = parse_cell_spec(text, kExample);
  if (!spec) return fail(spec.error());
  Cell cell;
  auto memory = open_memory(*spec);
  if (!memory) return fail(memory.error());
  cell.memory = std::move(*memory);
  for (const auto& place : spec->places) {
    const auto profile = profile_of(cell.profiles, place.family, folders);
    if (!profile) return fail(profile.error());
    for (const auto& other : cell.drives)
      if (other->node() == place.node && place.node != canopen::kUnconfigured)
        return spec->wrong(message("node-ID {} is given twice", place.node));
    const auto key = formatted("{}.{}", cell.drives.size() + 1, place.family);
    cell.drives.push_back(std::make_unique<SimDrive>(**profile, place.node, *cell.memory, key));
  }
  for (const auto& option : spec->options)
    if (const auto applied = apply_option(*spec, option, cell.drives, now); !applied)
      return fail(applied.error());
  return cell;
}

Result<std::unique_ptr<can::Bus>> open_sim(std::string_view spec,
                                           std::span<const std::filesystem::path> folders,
                                           SimBus::Clock clock) {
  const auto now = SimBus(clock).now();
  auto cell = build_cell(spec, folders, now);
  if (!cell) return fail(cell.error());
  return std::make_unique<CellBus>(std::move(*cell), clock);
}

}  // namespace servoctl::sim
