#include "session/write_plan.hpp"

#include <algorithm>
#include <optional>

#include "canopen/pdo.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "session/communication_order.hpp"

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

/// What can change while a PDO is valid.
struct WhileValid {
  bool mapping = false;  ///< Opened by its count; the COB-ID stays as it is where it does not change.
  bool timing = false;   ///< Inhibit time and SYNC start value.
};

/// The writes of one PDO, or of one assignment.
class BlockPlan {
 public:
  BlockPlan(const WhileValid& may, const Values& present, const Values& wanted, std::uint16_t block)
      : present_(&present),
        wanted_(&wanted),
        cob_id_{block, 1},
        list_(is_assignment(block) ? block : static_cast<std::uint16_t>(block + 0x200)) {
    const bool has_cob_id = list_ != block && has(cob_id_);
    if (has_cob_id) now_ = present.at(cob_id_);
    const bool valid = has_cob_id && (number(present, cob_id_) & canopen::kPdoInvalid) == 0;
    const auto place = canopen::pdo_at(block);
    const bool transmits = place && place->direction == canopen::PdoDirection::transmit;
    const bool timing = transmits && (differs({block, 3}) || differs({block, 6}));
    if (valid && (!may.mapping || differs(cob_id_) || (timing && !may.timing)))
      now_ = store_le(number(present, cob_id_) | canopen::kPdoInvalid, 4);
  }

  void add_switching_off(std::vector<PlannedWrite>& out) const {
    if (now_ && *now_ != present_->at(cob_id_)) out.push_back({cob_id_, *now_});
  }
  void add_settings(std::vector<PlannedWrite>& out) const {
    if (list_differs()) add_list(out);
    for (const auto& [object, data] : *wanted_)
      if (list_ != cob_id_.index && object.index == cob_id_.index && object.sub > 1 && differs(object))
        out.push_back({object, data});
  }
  void add_switching_on(std::vector<PlannedWrite>& out) const {
    if (now_ && *now_ != wanted_->at(cob_id_)) out.push_back({cob_id_, wanted_->at(cob_id_)});
  }

 private:
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

  const Values* present_;
  const Values* wanted_;
  ObjectAddress cob_id_;
  std::uint16_t list_;        ///< The mapping, or the assignment.
  std::optional<Bytes> now_;  ///< The COB-ID while the rest is set; empty where there is none.
};

/// No two PDOs may have one COB-ID at any moment, also when they exchange theirs: all are switched off before
/// the first is switched on.
void add_blocks(const std::vector<BlockPlan>& blocks, std::vector<PlannedWrite>& out) {
  for (const auto& block : blocks) block.add_switching_off(out);
  for (const auto& block : blocks) block.add_settings(out);
  for (const auto& block : blocks) block.add_switching_on(out);
}

/// When a value is written. A drive is first told where it is, then what it does, then what it sends.
enum class Step : std::uint8_t { address, parameter, communication, pdo, heartbeat };

class Order {
 public:
  /// `profile` may be null: no object is known as an address then.
  explicit Order(const drive::Profile* profile) {
    if (profile == nullptr) return;
    node_id_ = drive::place_of(*profile, profile->rules.nmt.node_id);
    bitrate_ = drive::place_of(*profile, profile->rules.nmt.bitrate);
  }

  Step step_of(ObjectAddress object) const {
    if (object == node_id_ || object == bitrate_) return Step::address;
    if (object.index >= kFirstOfMaker) return Step::parameter;
    if (block_of(object.index)) return Step::pdo;
    const bool is_heartbeat =
        object.index == objects::kProducerHeartbeat.index || object.index == kConsumerHeartbeat;
    return is_heartbeat ? Step::heartbeat : Step::communication;
  }

 private:
  static constexpr std::uint16_t kFirstOfMaker = 0x2000;  // CiA 301, table 37: below it is communication.
  static constexpr std::uint16_t kConsumerHeartbeat = 0x1016;

  std::optional<ObjectAddress> node_id_;
  std::optional<ObjectAddress> bitrate_;
};

/// `in_order` puts the writes of communication objects in theirs.
template <class InOrder>
std::vector<PlannedWrite> plan(const Order& order, const WhileValid& may, const Values& present,
                               const Values& wanted, const InOrder& in_order) {
  std::vector<PlannedWrite> out;
  std::set<std::uint16_t> blocks;
  for (const auto& [object, data] : wanted) {
    const auto found = present.find(object);
    if (found == present.end() || found->second == data) continue;
    if (const auto block = block_of(object.index))
      blocks.insert(*block);
    else
      out.push_back({object, data});
  }
  out = in_order(std::move(out));
  const auto by_step = [&](const PlannedWrite& a, const PlannedWrite& b) {
    return order.step_of(a.object) < order.step_of(b.object);
  };
  std::stable_sort(out.begin(), out.end(), by_step);
  const auto behind = std::find_if(out.begin(), out.end(), [&](const PlannedWrite& write) {
    return order.step_of(write.object) > Step::pdo;
  });
  std::vector<BlockPlan> plans;
  for (const auto block : blocks) plans.emplace_back(may, present, wanted, block);
  std::vector<PlannedWrite> pdos;
  add_blocks(plans, pdos);
  out.insert(behind, pdos.begin(), pdos.end());
  return out;
}

/// What stands for a value from before: another one, but for a COB-ID (the PDO is valid, and so made invalid
/// first) and for mapping entries that the count leaves unused.
Bytes any_before(const Values& wanted, ObjectAddress object, const Bytes& data) {
  const auto place = canopen::pdo_at(object.index);
  if (place && !place->mapping && object.sub == 1)
    return store_le(load_le(data) & ~std::uint64_t{canopen::kPdoInvalid}, data.size());
  const auto count = wanted.find({object.index, 0});
  if (place && place->mapping && object.sub > 0 && count != wanted.end() &&
      load_le(count->second) < object.sub)
    return data;
  auto out = data;
  for (auto& byte : out) byte = static_cast<std::uint8_t>(~byte);
  if (out.empty()) out.push_back(0);  // Any text but the empty one.
  return out;
}

}  // namespace

std::vector<PlannedWrite> plan_writes(const drive::Profile* profile, const Values& present,
                                      const Values& wanted) {
  WhileValid may;
  if (profile != nullptr) may = {profile->rules.pdo.disable_by_count, profile->rules.pdo.inhibit_while_valid};
  return plan(Order(profile), may, present, wanted,
              [&](auto writes) { return in_allowed_order(std::move(writes), present); });
}

std::vector<PlannedWrite> plan_writes_for_any_drive(const Values& wanted) {
  Values present;
  for (const auto& [object, data] : wanted) present.emplace(object, any_before(wanted, object, data));
  auto out = plan(Order(nullptr), {}, present, wanted,
                  [](auto writes) { return in_order_for_any_drive(std::move(writes)); });
  // A COB-ID that stands alone belongs to no procedure.
  for (const auto& [object, data] : wanted) {
    const auto planned = [&object = object](const PlannedWrite& write) { return write.object == object; };
    if (is_pdo_communication(object.index) && object.sub == 1 &&
        std::none_of(out.begin(), out.end(), planned))
      out.push_back({object, data});
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
