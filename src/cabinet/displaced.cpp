#include "cabinet/displaced.hpp"

#include <algorithm>
#include <map>

#include "base/format.hpp"
#include "base/text.hpp"
#include "cabinet/axis_identity.hpp"
#include "drive/standard_objects.hpp"
#include "session/identify.hpp"
#include "session/scan.hpp"
#include "settings/address_change.hpp"

namespace servoctl::cabinet {
namespace {

using settings::AddressEnd;

/// Nobody is there, or another drive.
bool is_missing(const Station& station, const PlannedAxis& look) {
  if (station.away || look.plan || !look.axis->serial || station.session->can() == nullptr) return false;
  const auto& error = look.plan.error();
  return error.code == Errc::timeout ||
         (error.code == Errc::refused && error.object == objects::kSerialNumber);
}

/// The serial numbers of the drives of one bus that are at no axis, or not at theirs; 0 is none.
std::map<std::uint8_t, std::uint32_t> strangers(session::Session& session, std::span<const Station> stations,
                                                std::span<const PlannedAxis> looks) {
  std::map<std::uint8_t, std::uint32_t> out;
  const auto nodes = session::nodes_present(session);
  if (!nodes) return out;
  for (const auto node : *nodes) {
    bool in_place = false;
    for (std::size_t i = 0; i < looks.size(); ++i)
      in_place =
          in_place || (stations[i].session == &session && looks[i].axis->node == node && looks[i].plan);
    if (in_place) continue;
    const auto identity = session::read_identity(session, node);
    if (identity && identity->serial.value_or(0) != 0) out.emplace(node, *identity->serial);
  }
  return out;
}

/// The one node at which this serial number is; 0 for none, or two.
std::uint8_t node_of(const std::map<std::uint8_t, std::uint32_t>& serials, std::uint32_t serial) {
  std::uint8_t out = 0;
  for (const auto& [node, one] : serials) {
    if (one != serial) continue;
    if (out != 0) return 0;
    out = node;
  }
  return out;
}

Result<void> put_in_place(const show::Desk& desk, const Station& station, const Displaced& drive, bool unlock,
                          std::vector<Message>& notices) {
  auto at = desk_at(desk, station);
  at.audience = desk.audience;
  const auto node = station.axis->node;
  const auto carry_out = [&]() -> Result<void> {
    const auto change = settings::plan_address(at, drive.at, {.node = node, .serial = drive.serial});
    if (!change) return fail(change.error());
    const std::uint8_t to[] = {node};
    if (const auto free = settings::refuse_taken(at, to); !free) return free;
    const auto outcome = settings::change_address(at, *change, {.unlock = unlock});
    if (outcome.error) return fail(*outcome.error);
    if (outcome.end == AddressEnd::moved) return {};
    return fail(make_error(Errc::negative,
                           message("its node-ID {} holds when it was switched off and on", node),
                           "switch it off and on, then repeat the line: it goes on from there"));
  };
  const auto done = carry_out();
  notices.insert(notices.end(), at.notices.begin(), at.notices.end());
  return done;
}

}  // namespace

std::vector<Displaced> find_displaced(const show::Desk& desk, std::span<const Station> stations,
                                      const PlanChoice& choice, std::span<PlannedAxis> looks) {
  std::vector<Displaced> out;
  std::map<session::Session*, std::map<std::uint8_t, std::uint32_t>> serials;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const auto& station = stations[i];
    if (!is_missing(station, looks[i])) continue;
    if (serials.count(station.session) == 0)
      serials.emplace(station.session, strangers(*station.session, stations, looks));
    auto there = *station.axis;
    there.node = node_of(serials.at(station.session), *there.serial);
    if (there.node == 0 || there.node == station.axis->node) continue;
    auto at = desk_at(desk, station);
    if (!hold_axis_identity(at, there, choice.families)) continue;
    looks[i].plan = fail(drive_error(
        Errc::negative, station.axis->node,
        message("its drive (serial number {}) is at node-ID {}", serial_text(*there.serial), there.node),
        "`cabinet apply` asks and gives it its node-ID first; what else differs is shown then"));
    out.push_back({i, there.node, *there.serial});
  }
  return out;
}

Result<void> place_displaced(const show::Desk& desk, const Cabinet& cabinet,
                             std::span<const Station> stations, const PlanChoice& choice, bool unlock,
                             std::span<PlannedAxis> looks) {
  const auto displaced = find_displaced(desk, stations, choice, looks);
  if (displaced.empty()) return {};
  std::string which;
  for (const auto& one : displaced)
    append(which,
           formatted("{} (serial number {}) from node-ID {} to {}", looks[one.look].axis->name,
                     serial_text(one.serial), one.at, looks[one.look].axis->node),
           ", ");
  if (const auto agreed = desk.confirm(formatted("Re-address {}?", which)); !agreed) return agreed;
  for (const auto& one : displaced) {
    auto& look = looks[one.look];
    const auto& station = stations[one.look];
    auto notices = std::move(look.notices);
    const auto placed = put_in_place(desk, station, one, unlock, notices);
    if (placed)
      look = look_at_all(desk, cabinet, std::span(&station, 1), choice).front();
    else
      look.plan = fail(placed.error());
    look.notices.insert(look.notices.begin(), notices.begin(), notices.end());
  }
  return {};
}

}  // namespace servoctl::cabinet
