#include "sim/cell_spec.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "canopen/node_id.hpp"
#include "drive/naming.hpp"
#include "drive/shared_profile.hpp"

namespace servoctl::sim {
namespace {

Result<CellSpec::Place> parse_place(const CellSpec& spec, std::string_view text) {
  const auto at = text.find('@');
  CellSpec::Place place;
  // The case of a family's name is all the same, that of a file's is not.
  const auto family = text.substr(0, at);
  place.family = family.find_first_of("./") == std::string_view::npos ? lower(family) : std::string(family);
  if (place.family.empty()) return spec.wrong("a simulated drive has no family name");
  if (at == std::string_view::npos) return place;
  const auto node = parse_digits(text.substr(at + 1), 10);
  if (node == canopen::kUnconfigured && !spec.has("lss"))
    return spec.wrong("a drive without a node-ID (255) can only be reached by LSS: add ?lss");
  if (!node ||
      ((*node < canopen::kFirstNode || *node > canopen::kLastNode) && *node != canopen::kUnconfigured))
    return spec.wrong(message("'{}' is not a node-ID (1..127)", as_it_is(text.substr(at + 1))));
  place.node = static_cast<std::uint8_t>(*node);
  return place;
}

CellSpec::Option parse_option(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos) return {text, {}};
  return {text.substr(0, equals), text.substr(equals + 1)};
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

Result<bool> plan_fault(const CellSpec& spec, std::string_view text, std::span<DriveModel* const> drives,
                        TimePoint now) {
  const auto at = text.find('@');
  const auto delay = parse_duration(at == std::string_view::npos ? "0s" : text.substr(at + 1));
  for (auto* drive : drives) {
    const auto alarm = alarm_of(drive->profile(), text.substr(0, at));
    if (!alarm || !delay)
      return spec.wrong(
          message("'fault={}' is not CODE@TIME or PANEL@TIME; options stand behind all drives: "
                  "sim:gsd600@1,dm@2?fault=0xFF00@2s",
                  as_it_is(text)));
    drive->raise_fault_at(*alarm, now + *delay);
  }
  return true;
}

Result<bool> set_counts(const CellSpec& spec, std::string_view text, std::span<DriveModel* const> drives) {
  const auto counts = parse_digits(text, 10);
  if (!counts || *counts < 2)
    return spec.wrong(message("'counts={}': counts per revolution must be 2 or more", as_it_is(text)));
  bool taken = false;
  for (auto* drive : drives) {
    if (!drive->has_own_counts()) continue;
    drive->own_counts() = static_cast<double>(*counts);
    taken = true;
  }
  if (taken) return true;
  return spec.wrong(
      message("'counts={}': all drives here report their counts per revolution", as_it_is(text)));
}

/// `NAME=VALUE` of a parameter of this family.
std::optional<std::pair<std::string, std::int64_t>> panel_value(const drive::Profile& profile,
                                                                std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos) return std::nullopt;
  const auto value = parse_signed(text.substr(equals + 1));
  const auto parameter = drive::resolve_parameter(profile, text.substr(0, equals));
  if (!value || !parameter) return std::nullopt;
  return std::pair((*parameter)->id, *value);
}

/// What was set on the panel of these drives.
Result<bool> set_on_panel(const CellSpec& spec, std::string_view text, std::span<DriveModel* const> drives) {
  for (const auto one : split(text, ',')) {
    bool known = false;
    for (auto* drive : drives) {
      const auto value = panel_value(drive->profile(), one);
      if (!value) continue;
      known = true;
      if (!drive->set_on_panel(value->first, value->second))
        return spec.wrong(message("'panel={}': {} cannot be set to {} on the panel of the {}", as_it_is(text),
                                  as_it_is(value->first), as_it_is(value->second),
                                  as_it_is(drive->profile().family)));
    }
    if (!known)
      return spec.wrong(
          message("'panel={}' is not NAME=VALUE of parameters that a drive here has: sim:sv2@1?panel=PA-20=0",
                  as_it_is(text)));
  }
  return true;
}

}  // namespace

bool CellSpec::has(std::string_view key) const {
  return std::any_of(options.begin(), options.end(), [&](const Option& option) { return option.key == key; });
}

tl::unexpected<Error> CellSpec::wrong(Message what) const {
  return fail(Errc::usage, std::move(what), std::string(example));
}

Result<CellSpec> parse_cell_spec(std::string_view text, std::string_view example) {
  CellSpec spec;
  spec.example = example;
  const auto question = text.find('?');
  if (question != std::string_view::npos)
    for (const auto option : split(text.substr(question + 1), '&'))
      spec.options.push_back(parse_option(option));
  for (const auto part : split(text.substr(0, question), ',')) {
    auto place = parse_place(spec, part);
    if (!place) return fail(place.error());
    spec.places.push_back(std::move(*place));
  }
  if (spec.places.empty()) return spec.wrong("no simulated drive is named");
  return spec;
}

Result<std::unique_ptr<Memory>> open_memory(const CellSpec& spec) {
  for (const auto& option : spec.options) {
    if (option.key != "state") continue;
    auto memory = Memory::open(std::string(option.value));
    if (!memory) return fail(memory.error());
    return std::make_unique<Memory>(std::move(*memory));
  }
  return std::make_unique<Memory>();
}

Result<const drive::Profile*> profile_of(std::vector<std::shared_ptr<const drive::Profile>>& known,
                                         const std::string& family,
                                         std::span<const std::filesystem::path> folders) {
  for (const auto& profile : known)
    if (profile->family == family) return profile.get();
  auto loaded = drive::shared_profile(family, folders);
  if (!loaded) return fail(loaded.error());
  known.push_back(std::move(*loaded));
  return known.back().get();
}

Result<Duration> time_of(const CellSpec& spec, const CellSpec::Option& option) {
  auto time = read_duration(option.value);
  if (!time)
    return spec.wrong(message("{}: {}; {}", as_it_is(option.key), time.error().message, time.error().hint));
  return time;
}

Result<std::vector<std::string_view>> lies_of(const CellSpec& spec, const CellSpec::Option& option,
                                              std::span<const std::string_view> known) {
  auto words = split(option.value, ',');
  const std::vector<std::string> names(known.begin(), known.end());
  for (const auto word : words)
    if (std::find(known.begin(), known.end(), word) == known.end())
      return spec.wrong(
          message("'lie={}': simulated drives here can lie by {}", as_it_is(option.value), one_of(names)));
  return words;
}

Result<bool> apply_drive_option(const CellSpec& spec, const CellSpec::Option& option,
                                std::span<DriveModel* const> drives, TimePoint now) {
  if (option.key == "fault") return plan_fault(spec, option.value, drives, now);
  if (option.key == "counts") return set_counts(spec, option.value, drives);
  if (option.key == "panel") return set_on_panel(spec, option.value, drives);
  return false;
}

}  // namespace servoctl::sim
