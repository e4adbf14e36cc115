#include "session/pdo_setup.hpp"

#include <algorithm>
#include <set>

#include "drive/naming.hpp"
#include "session/can_network.hpp"

namespace servoctl::session {
namespace {

using canopen::Pdo;
using canopen::PdoDirection;

/// Sub-indexes of a communication record (CiA 301, 7.5.2.33 and 7.5.2.37); 4 is reserved.
constexpr std::uint8_t kCommunicationSubs[] = {1, 2, 3, 5, 6};
/// A count of entries from here on means something else: a multiplexed PDO.
constexpr std::uint64_t kMostEntries = 0xFD;
/// Without a dictionary so many numbers are tried at once; when the last of them are not there, the rest is
/// not tried.
constexpr std::uint16_t kTrial = 8;
constexpr std::uint16_t kHole = 4;
constexpr std::uint16_t kMostPdos = 512;

bool is_pdo(ObjectAddress object) { return canopen::pdo_at(object.index).has_value(); }

/// What is read of each PDO before its entries: the communication record, and the count of the mapping.
std::vector<ObjectAddress> heads_of(const drive::Profile& profile) {
  std::vector<ObjectAddress> out;
  for (const auto direction : {PdoDirection::receive, PdoDirection::transmit})
    if (const auto list = assignment_of(&profile, direction)) out.push_back(*list);
  for (const auto& object : profile.dictionary.objects()) {
    const auto place = canopen::pdo_at(object.index);
    if (!place) continue;
    for (const auto& entry : object.entries)
      if (place->mapping ? entry.address.sub == 0
                         : std::count(std::begin(kCommunicationSubs), std::end(kCommunicationSubs),
                                      entry.address.sub) > 0)
        out.push_back(entry.address);
  }
  return out;
}

std::vector<ObjectAddress> heads_of(const Pdo& pdo) {
  std::vector<ObjectAddress> out;
  for (const auto sub : kCommunicationSubs) out.push_back({pdo.communication_index(), sub});
  out.push_back({pdo.mapping_index(), 0});
  return out;
}

/// One reading of many nodes.
class NodeReader {
 public:
  NodeReader(Session& session, std::span<const std::uint8_t> nodes)
      : session_(&session), nodes_(nodes), values_(nodes.size(), Values{}) {}

  /// Reads from each node what `wanted` says of it; a refused object is left out.
  template <class Wanted>
  void read(const Wanted& wanted) {
    std::vector<SdoRequest> requests;
    std::vector<std::size_t> owners;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (!values_[i]) continue;
      for (const auto object : wanted(i)) {
        requests.push_back({.node = nodes_[i], .object = object});
        owners.push_back(i);
      }
    }
    const auto answers = session_->transfer(requests);
    for (std::size_t k = 0; k < answers.size(); ++k) {
      auto& values = values_[owners[k]];
      if (!values) continue;
      if (answers[k])
        values->insert_or_assign(requests[k].object, *answers[k]);
      else if (answers[k].error().code != Errc::sdo_abort)
        values = fail(answers[k].error());
    }
  }

  /// Tries the numbers of one direction from 1 on, at each node until it has a hole that looks like the end.
  void try_numbers(PdoDirection direction) {
    for (std::uint16_t first = 1; first <= kMostPdos; first = static_cast<std::uint16_t>(first + kTrial)) {
      const auto last = static_cast<std::uint16_t>(first + kTrial - 1);
      const auto goes_on = [&](std::size_t i) {
        return first == 1 || has_any(i, direction, static_cast<std::uint16_t>(first - kHole),
                                     static_cast<std::uint16_t>(first - 1));
      };
      read([&](std::size_t i) {
        return goes_on(i) ? cob_ids(direction, first, last) : std::vector<ObjectAddress>();
      });
      bool any = false;
      for (std::size_t i = 0; i < nodes_.size(); ++i)
        any =
            any || (values_[i] && has_any(i, direction, static_cast<std::uint16_t>(last - kHole + 1), last));
      if (!any) break;
    }
  }

  /// The rest of what was found by its COB-ID.
  void read_found() {
    read([&](std::size_t i) {
      std::vector<ObjectAddress> out;
      for (const auto& pdo : pdos_of(*values_[i]))
        for (const auto object : heads_of(pdo))
          if (values_[i]->count(object) == 0) out.push_back(object);
      return out;
    });
  }

  void read_entries() {
    read([&](std::size_t i) {
      std::vector<ObjectAddress> out;
      for (const auto& [object, data] : *values_[i]) {
        const auto place = canopen::pdo_at(object.index);
        const bool list = !place || place->mapping;
        if (!list || object.sub != 0 || load_le(data) > kMostEntries) continue;
        for (std::uint8_t sub = 1; sub <= load_le(data); ++sub) out.push_back({object.index, sub});
      }
      return out;
    });
  }

  /// Where the drive refused the COB-ID of a record the dictionary has, the PDO is not there, whatever else
  /// answered.
  void drop_missing(const od::Dictionary& dictionary) {
    for (auto& values : values_)
      if (values)
        std::erase_if(*values, [&](const auto& value) {
          const auto place = canopen::pdo_at(value.first.index);
          if (!place) return false;
          const ObjectAddress cob_id{Pdo{place->direction, place->number}.communication_index(), 1};
          return dictionary.find(cob_id) != nullptr && values->count(cob_id) == 0;
        });
  }

  std::vector<Result<Values>> take() && { return std::move(values_); }

 private:
  static std::vector<ObjectAddress> cob_ids(PdoDirection direction, std::uint16_t first, std::uint16_t last) {
    std::vector<ObjectAddress> out;
    for (auto number = first; number <= last; ++number)
      out.push_back({Pdo{direction, number}.communication_index(), 1});
    return out;
  }
  bool has_any(std::size_t i, PdoDirection direction, std::uint16_t first, std::uint16_t last) const {
    const auto objects = cob_ids(direction, first, last);
    return values_[i] && std::any_of(objects.begin(), objects.end(),
                                     [&](ObjectAddress object) { return values_[i]->count(object) > 0; });
  }

  Session* session_;
  std::span<const std::uint8_t> nodes_;
  std::vector<Result<Values>> values_;
};

std::optional<std::uint32_t> number(const Values& values, ObjectAddress object) {
  const auto found = values.find(object);
  return found == values.end() ? std::nullopt
                               : std::optional(static_cast<std::uint32_t>(load_le(found->second)));
}

template <class T>
std::optional<T> number_as(const Values& values, ObjectAddress object) {
  const auto found = number(values, object);
  return found ? std::optional(static_cast<T>(*found)) : std::nullopt;
}

Pdo pdo_of(const Values& values, PdoDirection direction, std::uint16_t pdo_number) {
  Pdo out{direction, pdo_number};
  const auto communication = out.communication_index();
  const auto mapping = out.mapping_index();
  out.cob_id = number(values, {communication, 1}).value_or(canopen::kPdoInvalid);
  out.type = number_as<std::uint8_t>(values, {communication, 2}).value_or(out.type);
  out.inhibit = number_as<std::uint16_t>(values, {communication, 3});
  out.event = number_as<std::uint16_t>(values, {communication, 5});
  out.sync_start = number_as<std::uint8_t>(values, {communication, 6});
  const auto count = number(values, {mapping, 0}).value_or(0);
  for (std::uint8_t sub = 1; sub <= count && count <= kMostEntries; ++sub) {
    const auto entry = number(values, {mapping, sub});
    // Without one of them the others stand at bits nobody knows.
    if (!entry) {
      out.entries.clear();
      return out;
    }
    out.entries.push_back(canopen::parse_pdo_entry(*entry));
  }
  return out;
}

}  // namespace

std::vector<Result<Values>> read_pdo_values(Session& session, const drive::Profile* profile,
                                            std::span<const std::uint8_t> nodes) {
  auto* can = session.can();
  std::vector<canopen::NodeEpoch> epochs;
  if (can != nullptr)
    for (const auto node : nodes) epochs.push_back(can->epoch(node));
  NodeReader reading(session, nodes);
  const auto known = profile == nullptr ? std::vector<ObjectAddress>() : heads_of(*profile);
  if (known.empty()) {
    reading.try_numbers(PdoDirection::receive);
    reading.try_numbers(PdoDirection::transmit);
    reading.read_found();
  } else {
    reading.read([&](std::size_t) { return known; });
    reading.drop_missing(profile->dictionary);
  }
  reading.read_entries();
  auto out = std::move(reading).take();
  for (std::size_t i = 0; can != nullptr && i < out.size(); ++i) {
    if (out[i])
      can->learn_pdos(nodes[i], pdos_of(*out[i]), epochs[i]);
    else
      can->forget_pdos(nodes[i]);
  }
  return out;
}

std::vector<Pdo> pdos_of(const Values& values) {
  // By what stands first in the record; a communication record that refused even that is not there.
  std::set<std::pair<PdoDirection, std::uint16_t>> found;
  for (const auto& value : values) {
    const auto place = canopen::pdo_at(value.first.index);
    if (!place) continue;
    if (value.first.sub == (place->mapping ? 0 : 1)) found.emplace(place->direction, place->number);
  }
  std::vector<Pdo> out;
  for (const auto& [direction, pdo_number] : found) out.push_back(pdo_of(values, direction, pdo_number));
  return out;
}

std::vector<Result<std::vector<Pdo>>> read_pdos(Session& session, const drive::Profile* profile,
                                                std::span<const std::uint8_t> nodes) {
  std::vector<Result<std::vector<Pdo>>> out;
  for (const auto& values : read_pdo_values(session, profile, nodes)) out.push_back(values.map(pdos_of));
  return out;
}

Result<std::vector<Pdo>> read_pdos(Session& session, const drive::Profile* profile, std::uint8_t node) {
  return read_pdos(session, profile, std::span(&node, 1)).front();
}

Values default_pdo_values(const drive::Profile& profile, std::uint8_t node) {
  Values out;
  for (const auto& object : profile.dictionary.objects())
    for (const auto& entry : object.entries) {
      if (!is_pdo(entry.address) || !entry.default_value) continue;
      if (auto data = od::encode(entry.type, entry.default_value->for_node(node)))
        out.emplace(entry.address, std::move(*data));
    }
  // What the drive copies into the object at its start is what it starts with.
  const auto& with_node = profile.rules.mirror_add_node_id;
  for (const auto& parameter : profile.parameters) {
    const auto found = parameter.mirror ? out.find(*parameter.mirror) : out.end();
    const auto stored = parameter.default_value ? od::encode(parameter.type, *parameter.default_value)
                                                : fail(Errc::usage, {});
    if (found == out.end() || !stored) continue;
    const bool add = std::count(with_node.begin(), with_node.end(), *parameter.mirror) > 0;
    found->second = store_le(load_le(*stored) + (add ? node : 0U), found->second.size());
  }
  return out;
}

std::vector<std::uint16_t> assigned_pdos(const drive::Profile* profile, const Values& values) {
  std::vector<std::uint16_t> out;
  for (const auto direction : {PdoDirection::receive, PdoDirection::transmit}) {
    const auto list = assignment_of(profile, direction);
    const auto count = list ? number(values, *list).value_or(0) : 0;
    for (std::uint8_t sub = 1; sub <= count && count <= kMostEntries; ++sub)
      if (const auto record = number_as<std::uint16_t>(values, {list->index, sub})) out.push_back(*record);
  }
  return out;
}

std::optional<ObjectAddress> assignment_of(const drive::Profile* profile, PdoDirection direction) {
  if (profile == nullptr) return std::nullopt;
  const auto& rules = profile->rules.pdo;
  const auto& name = direction == PdoDirection::receive ? rules.assign_rpdo : rules.assign_tpdo;
  if (name.empty()) return std::nullopt;
  const auto target = drive::resolve(profile, name);
  return target ? std::optional(ObjectAddress{target->address.index, 0}) : std::nullopt;
}

}  // namespace servoctl::session
