#include "sim/esc_cell.hpp"

#include <fmt/format.h>
#include <utility>

#include "base/text.hpp"
#include "sim/cell_spec.hpp"

namespace servoctl::sim {
namespace {

constexpr std::string_view kExample =
    "simulated EtherCAT drives are written FAMILY@POSITION in the order of the ring, for example "
    "sv2@1,sv2@2?state=FILE";

Result<const drive::Profile*> coe_profile_of(EscCell& cell, const CellSpec::Place& place,
                                             std::span<const std::filesystem::path> folders) {
  const auto profile = profile_of(cell.profiles, place.family, folders);
  if (profile && !(*profile)->rules.coe.exists())
    return fail(
        Errc::usage,
        fmt::format("{} has no EtherCAT: the rules of this family have no [coe] section", place.family),
        fmt::format("put it on a simulated CAN bus: sim:{}@{}", place.family, place.node));
  return profile;
}

Result<void> apply_option(const CellSpec& spec, const CellSpec::Option& option, EscCell& cell,
                          TimePoint now) {
  if (option.key == "state") return {};
  std::vector<DriveModel*> models;
  for (const auto& slave : cell.slaves) models.push_back(&slave->model());
  const auto is_applied = apply_drive_option(spec, option, models, now);
  if (!is_applied) return fail(is_applied.error());
  if (*is_applied) return {};
  if (option.key != "delay") {
    const std::string keys[] = {"state", "fault", "delay", "counts"};
    return spec.wrong(
        fmt::format("'{}' is not an option of a simulated ring: use {}", option.key, one_of(keys)));
  }
  const auto time = time_of(spec, option);
  if (!time) return fail(time.error());
  for (const auto& slave : cell.slaves) slave->faults().answer_delay = *time;
  return {};
}

}  // namespace

Result<EscCell> build_esc_cell(std::string_view text, std::span<const std::filesystem::path> folders,
                               TimePoint now) {
  const auto spec = parse_cell_spec(text, kExample);
  if (!spec) return fail(spec.error());
  EscCell cell;
  auto memory = open_memory(*spec);
  if (!memory) return fail(memory.error());
  cell.memory = std::move(*memory);
  for (const auto& place : spec->places) {
    const auto profile = coe_profile_of(cell, place, folders);
    if (!profile) return fail(profile.error());
    const auto position = cell.slaves.size() + 1;
    if (place.node != position)
      return spec->wrong(fmt::format(
          "drive {0} of an EtherCAT ring is node {0}, not {1}: nodes are positions", position, place.node));
    const auto key = fmt::format("{}.{}", position, place.family);
    cell.slaves.push_back(std::make_unique<EscSlave>(**profile, place.node, *cell.memory, key));
    cell.ring.attach(*cell.slaves.back(), now);
  }
  for (const auto& option : spec->options)
    if (const auto applied = apply_option(*spec, option, cell, now); !applied) return fail(applied.error());
  return cell;
}

}  // namespace servoctl::sim
