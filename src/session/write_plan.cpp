#include "session/write_plan.hpp"

#include <algorithm>
#include <optional>

#include "canopen/pdo.hpp"

namespace servoctl::session {
namespace {

/// Objects that choose among fixed PDOs (CoE, sync manager assignment): a list with its count, as a mapping
/// is.
bool is_assignment(std::uint16_t index) { return index >= 0x1C10 && index <= 0x1C2F; }

/// What is written as a whole: the two records of a PDO under the index of the first, or an assignment. Empty
/// for other objects.
std::optional<std::uint16_t> block_of(std::uint16_t index) {
  if (is_assignment(index)) return index;
  const auto place = canopen::pdo_at(index);
  if (!place) return std::nullopt;
  return canopen::Pdo{place->direction, place->number}.communication_index();
}

/// The writes of one PDO, or of one assignment.
class PdoPlan {
 public:
  PdoPlan(const drive::Profile* profile, const Values& present, const Values& wanted, std::uint16_t block)
      : by_count_(profile != nullptr && profile->rules.pdo.disable_by_count),
        present_(&present),
        wanted_(&wanted),
        communication_(block),
        list_(is_assignment(block) ? block : static_cast<std::uint16_t>(block + 0x200)) {}

  void add_to(std::vector<PlannedWrite>& out) {
    if (list_ != communication_)
      add_pdo(out);
    else if (list_differs())
      add_list(out);
  }

 private:
  void add_pdo(std::vector<PlannedWrite>& out) const {
    const ObjectAddress cob_id{communication_, 1};
    const bool valid = has(cob_id) && (number(*present_, cob_id) & canopen::kPdoInvalid) == 0;
    const bool switch_off = valid && (!by_count_ || differs(cob_id));
    auto now = has(cob_id) ? present_->at(cob_id) : Bytes();
    if (switch_off) {
      now = store_le(number(*present_, cob_id) | canopen::kPdoInvalid, 4);
      out.push_back({cob_id, now});
    }
    if (list_differs()) add_list(out);
    for (const auto& [object, data] : *wanted_)
      if (object.index == communication_ && object.sub > 1 && differs(object)) out.push_back({object, data});
    if (has(cob_id) && now != wanted_->at(cob_id)) out.push_back({cob_id, wanted_->at(cob_id)});
  }

  static std::uint32_t number(const Values& values, ObjectAddress object) {
    const auto& bytes = values.at(object);
    return static_cast<std::uint32_t>(load_le(ByteSpan(bytes).first(std::min<std::size_t>(bytes.size(), 8))));
  }
  bool has(ObjectAddress object) const { return wanted_->count(object) > 0 && present_->count(object) > 0; }
  bool differs(ObjectAddress object) const {
    return has(object) && present_->at(object) != wanted_->at(object);
  }
  bool list_differs() const {
    return std::any_of(wanted_->begin(), wanted_->end(),
                       [&](const auto& value) { return value.first.index == list_ && differs(value.first); });
  }
  /// Count 0 may have cleared the entries: those in use are written although they do not differ.
  void add_list(std::vector<PlannedWrite>& out) const {
    const ObjectAddress count{list_, 0};
    const auto used = has(count) ? number(*wanted_, count) : 0;
    if (has(count) && number(*present_, count) != 0)
      out.push_back({count, Bytes(present_->at(count).size(), 0)});
    for (const auto& [object, data] : *wanted_)
      if (object.index == list_ && object.sub > 0 && has(object) && (object.sub <= used || differs(object)))
        out.push_back({object, data});
    if (used != 0) out.push_back({count, wanted_->at(count)});
  }

  bool by_count_;
  const Values* present_;
  const Values* wanted_;
  std::uint16_t communication_;
  std::uint16_t list_;  ///< The mapping, or the assignment.
};

}  // namespace

std::vector<PlannedWrite> plan_writes(const drive::Profile* profile, const Values& present,
                                      const Values& wanted) {
  std::vector<PlannedWrite> out;
  std::optional<std::uint16_t> planned;
  const auto differs = [&](ObjectAddress object, const Bytes& data) {
    const auto found = present.find(object);
    return found != present.end() && found->second != data;
  };
  for (const auto& each : wanted) {
    const auto object = each.first;
    const auto& data = each.second;
    if (!differs(object, data)) continue;
    const auto block = block_of(object.index);
    if (!block) {
      out.push_back({object, data});
      continue;
    }
    if (block == planned) continue;
    // A block is planned where its first difference is met, communication or mapping.
    const bool met = std::any_of(wanted.begin(), wanted.end(), [&](const auto& value) {
      return value.first < object && block_of(value.first.index) == block &&
             differs(value.first, value.second);
    });
    if (met) continue;
    planned = block;
    PdoPlan(profile, present, wanted, *block).add_to(out);
  }
  return out;
}

std::set<ObjectAddress> touched_by(const std::vector<PlannedWrite>& plan, const Values& present) {
  std::set<ObjectAddress> out;
  for (const auto& write : plan) {
    const auto index = write.object.index;
    const auto place = canopen::pdo_at(index);
    const bool list = (place && place->mapping) || is_assignment(index);
    for (const auto& value : present)
      if (list ? value.first.index == index : value.first == write.object) out.insert(value.first);
  }
  return out;
}

}  // namespace servoctl::session
