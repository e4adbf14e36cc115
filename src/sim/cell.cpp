#include "sim/cell.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "base/duration.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/node_id.hpp"

namespace servoctl::sim {
namespace {

struct Place {
  std::string family;
  std::uint8_t node = 1;
};

tl::unexpected<Error> bad_spec(std::string what) {
  return fail(Errc::usage, std::move(what),
              "simulated drives are written sim:FAMILY@NODE, for example sim:gsd600@1,gsd600@2?state=FILE");
}

Result<Place> parse_place(std::string_view text) {
  const auto at = text.find('@');
  Place place;
  // The case of a family's name is all the same, that of a file's is not.
  const auto family = text.substr(0, at);
  place.family = family.find_first_of("./") == std::string_view::npos ? lower(family) : std::string(family);
  if (place.family.empty()) return bad_spec("a simulated drive has no family name");
  if (at == std::string_view::npos) return place;
  const auto node = parse_digits(text.substr(at + 1), 10);
  if (!node || *node < canopen::kFirstNode || *node > canopen::kLastNode)
    return bad_spec(fmt::format("'{}' is not a node-ID (1..127)", text.substr(at + 1)));
  place.node = static_cast<std::uint8_t>(*node);
  return place;
}

Result<const drive::Profile*> profile_of(Cell& cell, const std::string& family,
                                         std::span<const std::filesystem::path> folders) {
  for (const auto& known : cell.profiles)
    if (known->family == family) return known.get();
  auto loaded = drive::load_profile(family, folders);
  if (!loaded) return fail(loaded.error());
  cell.profiles.push_back(std::make_unique<drive::Profile>(std::move(*loaded)));
  return cell.profiles.back().get();
}

/// A fault by its code, or by what the panel shows: then its code and vendor bytes are looked up.
std::optional<Alarm> alarm_of(const drive::Profile& profile, std::string_view text) {
  if (const auto code = parse_integer(text))
    return code->negative || code->magnitude > 0xFFFF
               ? std::nullopt
               : std::optional(Alarm{static_cast<std::uint16_t>(code->magnitude), {}});
  for (const auto& fault : profile.faults)
    if (equals_nocase(fault.panel, text) && fault.code)
      return Alarm{*fault.code, drive::panel_bytes(profile.rules.emergency, fault.panel)};
  return std::nullopt;
}

Result<void> plan_fault(Cell& cell, std::string_view text, TimePoint now) {
  const auto at = text.find('@');
  const auto delay = parse_duration(at == std::string_view::npos ? "0s" : text.substr(at + 1));
  for (const auto& drive : cell.drives) {
    const auto alarm = alarm_of(drive->profile(), text.substr(0, at));
    if (!alarm || !delay)
      return bad_spec(
          fmt::format("'fault={}' is not CODE@TIME or PANEL@TIME, such as fault=0xFF00@2s", text));
    drive->raise_fault_at(*alarm, now + *delay);
  }
  return {};
}

/// Whether a turn of its motor has counts that no object tells.
bool has_own_counts(const drive::Profile& profile) {
  const auto ways = profile.rules.units.find(drive::Measure::increments_per_turn);
  return ways != profile.rules.units.end() &&
         std::any_of(ways->second.begin(), ways->second.end(), [](const auto& way) { return way.learned; });
}

Result<void> set_counts(Cell& cell, std::string_view text) {
  const auto counts = parse_digits(text, 10);
  if (!counts || *counts < 2)
    return bad_spec(fmt::format("'counts={}': counts per revolution must be 2 or more", text));
  bool taken = false;
  for (const auto& drive : cell.drives) {
    if (!has_own_counts(drive->profile())) continue;
    drive->own_counts() = static_cast<double>(*counts);
    taken = true;
  }
  if (taken) return {};
  return bad_spec(fmt::format("'counts={}': all drives here report their counts per revolution", text));
}

Result<void> apply_option(Cell& cell, std::string_view option, TimePoint now) {
  const auto equals = option.find('=');
  const auto key = option.substr(0, equals);
  const auto value = equals == std::string_view::npos ? std::string_view() : option.substr(equals + 1);
  if (key == "state") return {};
  if (key == "fault") return plan_fault(cell, value, now);
  if (key == "counts") return set_counts(cell, value);
  const auto time = read_duration(value);
  if (key != "silent" && key != "delay") {
    const std::string keys[] = {"state", "fault", "silent", "delay", "counts"};
    return bad_spec(fmt::format("'{}' is not an option of a simulated bus: use {}", key, one_of(keys)));
  }
  if (!time) return bad_spec(fmt::format("{}: {}; {}", key, time.error().message, time.error().hint));
  for (const auto& drive : cell.drives) {
    if (key == "silent") drive->fall_silent_at(now + *time);
    if (key == "delay") drive->wire_faults().answer_delay = *time;
  }
  return {};
}

Result<std::unique_ptr<Memory>> open_memory(std::span<const std::string_view> options) {
  for (const auto option : options) {
    if (!option.starts_with("state=")) continue;
    auto memory = Memory::open(std::string(option.substr(6)));
    if (!memory) return fail(memory.error());
    return std::make_unique<Memory>(std::move(*memory));
  }
  return std::make_unique<Memory>();
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

Result<Cell> build_cell(std::string_view spec, std::span<const std::filesystem::path> folders,
                        TimePoint now) {
  const auto question = spec.find('?');
  const auto options = question == std::string_view::npos ? std::vector<std::string_view>()
                                                          : split(spec.substr(question + 1), '&');
  const auto places = split(spec.substr(0, question), ',');
  if (places.empty()) return bad_spec("no simulated drive is named");
  Cell cell;
  auto memory = open_memory(options);
  if (!memory) return fail(memory.error());
  cell.memory = std::move(*memory);
  for (const auto text : places) {
    const auto place = parse_place(text);
    if (!place) return fail(place.error());
    const auto profile = profile_of(cell, place->family, folders);
    if (!profile) return fail(profile.error());
    for (const auto& other : cell.drives)
      if (other->node() == place->node)
        return bad_spec(fmt::format("node-ID {} is given twice", place->node));
    const auto key = fmt::format("{}.{}", cell.drives.size() + 1, place->family);
    cell.drives.push_back(std::make_unique<SimDrive>(**profile, place->node, *cell.memory, key));
  }
  for (const auto option : options)
    if (const auto applied = apply_option(cell, option, now); !applied) return fail(applied.error());
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
