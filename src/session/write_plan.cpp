#include "session/write_plan.hpp"

#include <algorithm>

namespace servoctl::session {
namespace {

constexpr std::uint32_t kInvalid = 0x8000'0000;

bool is_communication(std::uint16_t index) {
  return (index >= 0x1400 && index <= 0x15FF) || (index >= 0x1800 && index <= 0x19FF);
}
bool is_mapping(std::uint16_t index) {
  return (index >= 0x1600 && index <= 0x17FF) || (index >= 0x1A00 && index <= 0x1BFF);
}
/// 1400h stands for itself and its mapping 1600h.
std::uint16_t block_of(std::uint16_t index) {
  return is_mapping(index) ? static_cast<std::uint16_t>(index - 0x200) : index;
}

/// The writes of one PDO.
class PdoPlan {
 public:
  PdoPlan(const drive::Profile* profile, const Values& present, const Values& wanted,
          std::uint16_t communication)
      : by_count_(profile != nullptr && profile->rules.pdo.disable_by_count),
        present_(&present),
        wanted_(&wanted),
        communication_(communication),
        mapping_(static_cast<std::uint16_t>(communication + 0x200)) {}

  void add_to(std::vector<PlannedWrite>& out) {
    const ObjectAddress cob_id{communication_, 1};
    const bool valid = has(cob_id) && (number(*present_, cob_id) & kInvalid) == 0;
    const bool move_id = differs(cob_id);
    const bool switch_off = valid && (!by_count_ || move_id);
    if (switch_off) out.push_back({cob_id, store_le(number(*present_, cob_id) | kInvalid, 4)});
    if (mapping_differs()) add_mapping(out);
    for (const auto& [object, data] : *wanted_)
      if (object.index == communication_ && object.sub > 1 && differs(object)) out.push_back({object, data});
    if (has(cob_id) && (switch_off || move_id)) out.push_back({cob_id, wanted_->at(cob_id)});
  }

 private:
  static std::uint32_t number(const Values& values, ObjectAddress object) {
    return static_cast<std::uint32_t>(load_le(values.at(object)));
  }
  bool has(ObjectAddress object) const { return wanted_->count(object) > 0 && present_->count(object) > 0; }
  bool differs(ObjectAddress object) const {
    return has(object) && present_->at(object) != wanted_->at(object);
  }
  bool mapping_differs() const {
    return std::any_of(wanted_->begin(), wanted_->end(), [&](const auto& value) {
      return value.first.index == mapping_ && differs(value.first);
    });
  }
  void add_mapping(std::vector<PlannedWrite>& out) const {
    const ObjectAddress count{mapping_, 0};
    if (has(count) && number(*present_, count) != 0) out.push_back({count, store_le(0, 1)});
    for (const auto& [object, data] : *wanted_)
      if (object.index == mapping_ && object.sub > 0 && differs(object)) out.push_back({object, data});
    if (has(count) && number(*wanted_, count) != 0) out.push_back({count, wanted_->at(count)});
  }

  bool by_count_;
  const Values* present_;
  const Values* wanted_;
  std::uint16_t communication_;
  std::uint16_t mapping_;
};

}  // namespace

std::vector<PlannedWrite> plan_writes(const drive::Profile* profile, const Values& present,
                                      const Values& wanted) {
  std::vector<PlannedWrite> out;
  std::uint16_t planned = 0;
  const auto differs = [&](ObjectAddress object, const Bytes& data) {
    const auto found = present.find(object);
    return found != present.end() && found->second != data;
  };
  for (const auto& each : wanted) {
    const auto object = each.first;
    const auto& data = each.second;
    if (!differs(object, data)) continue;
    if (!is_communication(object.index) && !is_mapping(object.index)) {
      out.push_back({object, data});
      continue;
    }
    const auto block = block_of(object.index);
    if (block == planned) continue;
    // A block is planned where its first difference is met, communication or mapping.
    const bool met = std::any_of(wanted.begin(), wanted.end(), [&](const auto& value) {
      return value.first < object && block_of(value.first.index) == block &&
             differs(value.first, value.second);
    });
    if (met) continue;
    planned = block;
    PdoPlan(profile, present, wanted, block).add_to(out);
  }
  return out;
}

}  // namespace servoctl::session
