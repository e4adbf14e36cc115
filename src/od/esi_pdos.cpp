#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "od/esi_layout.hpp"

namespace servoctl::od {
namespace {

constexpr std::uint16_t kOutputAssignment = 0x1C12;
constexpr std::uint16_t kInputAssignment = 0x1C13;
constexpr std::string_view kPdoNote = "from the PDOs of the file; its dictionary does not list it";
constexpr std::string_view kPdoNoteZh = "来自文件中的 PDO；其对象字典未列出";

Entry number_entry(ObjectAddress address, std::string name, DataType type, Access access,
                   std::uint64_t value) {
  Entry out;
  out.address = address;
  out.name = std::move(name);
  out.type = type;
  out.access = access;
  out.default_value = NodeValue{Value(value), false};
  out.note = kPdoNote;
  out.note_zh = kPdoNoteZh;
  return out;
}

/// What its entries are called in Chinese.
std::string chinese_name(std::uint16_t index, std::size_t sub) {
  if (sub == 0) return "最大子索引";
  if (is_pdo_mapping(index)) return formatted("映射对象 {}", sub);
  return formatted("{} 分配 {}", index == kOutputAssignment ? "RxPDO" : "TxPDO", sub);
}

/// A list of numbers with its count in sub 0, as mappings and assignments are.
Object list_of(std::uint16_t index, std::string name, DataType type, Access access,
               const std::vector<std::uint64_t>& values, std::uint32_t line) {
  Object out;
  out.index = index;
  out.code = ObjectCode::array;
  out.entries.push_back(number_entry({index, 0}, "highest sub-index", DataType::u8, access, values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
    out.entries.push_back(number_entry({index, static_cast<std::uint8_t>(i + 1)},
                                       formatted("{} {}", name, i + 1), type, access, values[i]));
  for (auto& entry : out.entries) {
    entry.line = line;
    entry.name_zh = chinese_name(index, entry.address.sub);
  }
  out.name = std::move(name);
  return out;
}

void add_mapping(const EsiPdo& pdo, bool can_change, Dictionary& dictionary) {
  if (dictionary.object(pdo.index) != nullptr) return;
  std::vector<std::uint64_t> values;
  for (const auto& entry : pdo.entries)
    values.push_back(std::uint64_t{entry.object.index} << 16U | std::uint64_t{entry.object.sub} << 8U |
                     entry.bits);
  const bool receive = pdo.direction == PdoDirection::receive;
  auto name = formatted("{} mapping", pdo.name.empty() ? std::string(receive ? "RxPDO" : "TxPDO") : pdo.name);
  dictionary.add(list_of(pdo.index, std::move(name), DataType::u32,
                         can_change && !pdo.fixed ? Access::rw : Access::ro, values, pdo.line));
}

void add_assignment(const EsiLayout& layout, PdoDirection direction, Dictionary& dictionary) {
  const bool receive = direction == PdoDirection::receive;
  const auto index = receive ? kOutputAssignment : kInputAssignment;
  if (dictionary.object(index) != nullptr) return;
  std::vector<std::uint64_t> values;
  std::uint32_t line = 0;
  for (const auto& pdo : layout.pdos) {
    if (pdo.direction != direction) continue;
    if (line == 0) line = pdo.line;
    if (pdo.sync_manager || pdo.mandatory) values.push_back(pdo.index);
  }
  if (line == 0) return;
  // Nothing assigned: a first place remains, for what is to be.
  const bool none = values.empty();
  if (none) values.push_back(0);
  auto object = list_of(index, receive ? "RxPDO assignment" : "TxPDO assignment", DataType::u16,
                        layout.pdo_assign ? Access::rw : Access::ro, values, line);
  if (none) object.entries.front().default_value = NodeValue{Value(std::uint64_t{0}), false};
  dictionary.add(std::move(object));
}

PdoMapping with(PdoMapping mapping, PdoDirection direction) {
  const auto own = direction == PdoDirection::receive ? PdoMapping::rpdo : PdoMapping::tpdo;
  return mapping == PdoMapping::no || mapping == own ? own : PdoMapping::both;
}

/// An object that is known from a PDO alone: outputs can be written, inputs read.
void add_mapped(const EsiPdoEntry& from, PdoDirection direction, Dictionary& dictionary) {
  if (!from.type) return;
  Entry entry;
  entry.address = from.object;
  entry.name = from.name;
  entry.name_zh = from.name_zh;
  entry.type = *from.type;
  entry.access = direction == PdoDirection::receive ? Access::rw : Access::ro;
  entry.note = kPdoNote;
  entry.note_zh = kPdoNoteZh;
  entry.line = from.line;
  auto object =
      dictionary.object(from.object.index) != nullptr ? *dictionary.object(from.object.index) : Object{};
  if (object.entries.empty()) {
    object.index = from.object.index;
    object.name = from.name;
    object.code = from.object.sub == 0 ? ObjectCode::var : ObjectCode::record;
  } else {
    object.code = ObjectCode::record;
  }
  const auto place = std::find_if(object.entries.begin(), object.entries.end(),
                                  [&](const Entry& e) { return e.address.sub > entry.address.sub; });
  object.entries.insert(place, std::move(entry));
  dictionary.add(std::move(object));
}

}  // namespace

void add_esi_pdos(const EsiLayout& layout, bool has_dictionary, Dictionary& dictionary) {
  for (const auto& pdo : layout.pdos)
    for (const auto& from : pdo.entries) {
      if (from.object.index == 0) continue;
      if (!has_dictionary && dictionary.find(from.object) == nullptr)
        add_mapped(from, pdo.direction, dictionary);
      if (auto* entry = dictionary.find(from.object); entry != nullptr)
        entry->pdo = with(entry->pdo, pdo.direction);
    }
  if (!layout.coe) return;
  for (const auto& pdo : layout.pdos)
    if (is_pdo_mapping(pdo.index)) add_mapping(pdo, layout.pdo_config, dictionary);
  add_assignment(layout, PdoDirection::receive, dictionary);
  add_assignment(layout, PdoDirection::transmit, dictionary);
}

}  // namespace servoctl::od
