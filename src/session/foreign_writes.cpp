#include "session/foreign_writes.hpp"

#include <set>
#include <utility>

#include "canopen/sdo_frame.hpp"
#include "session/pdo_setup.hpp"

namespace servoctl::session {
namespace {

using canopen::Pdo;
using canopen::PdoDirection;

/// Of a drive whose data list no RPDO (CiA 402-3 describes these).
constexpr std::uint16_t kUsualRpdos = 4;

/// Those that the data list.
std::set<std::uint16_t> rpdo_numbers(const drive::Profile& profile) {
  std::set<std::uint16_t> out;
  for (const auto& object : profile.dictionary.objects())
    if (const auto place = canopen::pdo_at(object.index);
        place && !place->mapping && place->direction == PdoDirection::receive)
      out.insert(place->number);
  return out;
}

/// Reads these objects of one node, each by a request of its own: one that is not answered says nothing of
/// the others. What the node refuses is left out. `guessed`: nobody says that they are there, and the first
/// one that it has no proper answer for ends the reading.
Result<void> read_into(Values& values, Session& session, std::uint8_t node,
                       const std::vector<ObjectAddress>& objects, bool guessed = false) {
  for (const auto object : objects) {
    auto answer = session.upload(node, object);
    const auto code = answer ? Errc::sdo_abort : answer.error().code;
    if (guessed && (code == Errc::timeout || code == Errc::protocol)) return {};
    if (!answer && code != Errc::sdo_abort) return fail(answer.error());
    if (answer) values[object] = std::move(*answer);
  }
  return {};
}

}  // namespace

ForeignWrites::ForeignWrites(Session& session, std::uint8_t node, OnWrite on_write)
    : session_(&session),
      node_(node),
      on_write_(std::move(on_write)),
      hearing_(session, [this](const can::Frame& frame, TimePoint) { hear(frame); }) {}

void ForeignWrites::hear(const can::Frame& frame) const {
  if (const auto write = canopen::sdo_write_request(frame); write && write->node == node_)
    on_write_(write->object, Way::sdo);
  if (frame.remote || frame.error) return;
  for (const auto& pdo : rpdos_)
    if (pdo.can_id() == canopen::can_id_of(frame))
      for (const auto& entry : pdo.entries)
        if (!entry.is_gap()) on_write_(entry.object, Way::rpdo);
}

Result<void> ForeignWrites::learn_rpdos(const drive::Profile& profile) {
  if (session_->can() == nullptr) return {};
  Values values;
  std::vector<ObjectAddress> heads;
  std::vector<ObjectAddress> counts;
  std::vector<ObjectAddress> entries;
  auto numbers = rpdo_numbers(profile);
  const bool are_guessed = numbers.empty();
  for (std::uint16_t number = 1; are_guessed && number <= kUsualRpdos; ++number) numbers.insert(number);
  for (const auto number : numbers)
    heads.push_back({Pdo{PdoDirection::receive, number}.communication_index(), 1});
  if (auto read = read_into(values, *session_, node_, heads, are_guessed); !read) return read;
  for (const auto& pdo : pdos_of(values))
    if (pdo.is_valid()) counts.push_back({pdo.mapping_index(), 0});
  if (auto read = read_into(values, *session_, node_, counts); !read) return read;
  for (const auto count : counts) {
    const auto found = values.find(count);
    // More than 64 entries of a bit have no room in a frame: another meaning of the count.
    if (found == values.end() || load_le(found->second) > 64) continue;
    for (std::uint8_t sub = 1; sub <= load_le(found->second); ++sub) entries.push_back({count.index, sub});
  }
  if (auto read = read_into(values, *session_, node_, entries); !read) return read;
  rpdos_.clear();
  for (auto& pdo : pdos_of(values))
    if (pdo.is_valid() && !pdo.entries.empty()) rpdos_.push_back(std::move(pdo));
  return {};
}

}  // namespace servoctl::session
