#include "sim/esc_cell.hpp"

#include <utility>

#include "base/format.hpp"
#include "sim/cell_spec.hpp"
#include "sim/esc_cell_options.hpp"

namespace servoctl::sim {
namespace {

constexpr std::string_view kRingExample =
    "simulated EtherCAT drives are written FAMILY@POSITION in the order of the ring, for example "
    "sv2@1,sv2@2?state=FILE";

Result<const drive::Profile*> coe_profile_of(EscCell& cell, const CellSpec::Place& place,
                                             std::span<const std::filesystem::path> folders) {
  const auto profile = profile_of(cell.profiles, place.family, folders);
  if (profile && !(*profile)->rules.coe.exists())
    return fail(
        Errc::usage,
        message("{} has no EtherCAT: the rules of this family have no [coe] section", as_it_is(place.family)),
        message("put it on a simulated CAN bus: sim:{}@{}", as_it_is(place.family), place.node));
  return profile;
}

}  // namespace

Result<EscCell> build_esc_cell(std::string_view text, std::span<const std::filesystem::path> folders,
                               TimePoint now) {
  const auto spec = parse_cell_spec(text, kRingExample);
  if (!spec) return fail(spec.error());
  const auto sii = sii_fault_of(*spec);
  if (!sii) return fail(sii.error());
  EscCell cell;
  auto memory = open_memory(*spec);
  if (!memory) return fail(memory.error());
  cell.memory = std::move(*memory);
  for (const auto& place : spec->places) {
    const auto profile = coe_profile_of(cell, place, folders);
    if (!profile) return fail(profile.error());
    const auto position = cell.slaves.size() + 1;
    if (place.node != position)
      return spec->wrong(message("drive {0} of an EtherCAT ring is node {0}, not {1}: nodes are positions",
                                 position, place.node));
    const auto key = formatted("{}.{}", position, place.family);
    auto options = EscSlave::Options::of(**profile);
    options.sii = *sii;
    cell.slaves.push_back(std::make_unique<EscSlave>(**profile, place.node, *cell.memory, key, options));
    cell.ring.attach(*cell.slaves.back(), now);
  }
  for (const auto& option : spec->options)
    if (const auto applied = apply_option(*spec, option, cell, now); !applied) return fail(applied.error());
  return cell;
}

}  // namespace servoctl::sim
