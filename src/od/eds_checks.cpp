#include "od/eds_checks.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/format.hpp"
#include "base/pdo_index.hpp"

namespace servoctl::od {
namespace {

constexpr std::uint64_t kMostBits = 64;
constexpr std::uint64_t kMostEntries = 64;  // Above are the marks of multiplexed PDOs.

std::optional<std::uint64_t> number_in(const std::optional<NodeValue>& value) {
  const auto* number = value && !value->plus_node_id ? std::get_if<std::uint64_t>(&value->value) : nullptr;
  return number != nullptr ? std::optional(*number) : std::nullopt;
}

/// One object of mapping, by default or as configured.
class Mapping {
 public:
  using Value = std::optional<NodeValue> Entry::*;

  Mapping(const Dictionary& dictionary, const Object& object, Findings& findings)
      : dictionary_(&dictionary), object_(&object), findings_(&findings) {}

  void check(Value value, std::string_view key) {
    if (object_->entries.empty() || object_->entries.front().address.sub != 0) return;
    const auto count = number_in(object_->entries.front().*value);
    if (count && *count > kMostEntries) return;
    std::uint64_t bits = 0;
    for (const auto& entry : object_->entries) {
      const auto map = number_in(entry.*value);
      if (entry.address.sub == 0 || entry.type != DataType::u32 || !map || *map == 0) continue;
      if (count && entry.address.sub <= *count) bits += *map & 0xFFU;
      check_entry(entry, *map, key);
    }
    // Without a communication record it is no PDO of CAN: an EtherCAT device maps more.
    const auto communication = static_cast<std::uint16_t>(object_->index - 0x200);
    if (bits > kMostBits && dictionary_->object(communication) != nullptr)
      tell(object_->entries.front(), "mapping-too-long",
           formatted("{}: {:04X} maps {} bits; a PDO has {}", key, object_->index, bits, kMostBits),
           "map less, or lower sub 0");
  }

 private:
  void check_entry(const Entry& entry, std::uint64_t map, std::string_view key) {
    constexpr std::uint16_t kLastDummy = 0x1F;
    const ObjectAddress target{static_cast<std::uint16_t>(map >> 16U), static_cast<std::uint8_t>(map >> 8U)};
    const auto bits = map & 0xFFU;
    const bool dummy = target.index <= kLastDummy;
    const auto* mapped = dictionary_->find(target);
    const auto type = dummy               ? data_type_from_cia(target.index)
                      : mapped != nullptr ? std::optional(mapped->type)
                                          : std::nullopt;
    if (!type) {
      tell(entry, "mapping-absent",
           formatted("{}: {} maps {}, which the file does not have", key, to_string(entry.address),
                     to_string(target)),
           "map another object, or add its section");
      return;
    }
    const auto size = size_of(*type);
    if (!size || bits == 8 * *size || (*type == DataType::boolean && bits == 1)) return;
    tell(entry, "mapping-length",
         formatted("{}: {} maps {} bits of {}, which is {} ({} bits)", key, to_string(entry.address), bits,
                   to_string(target), name(*type), *type == DataType::boolean ? 1 : 8 * *size),
         "write the length of the object in bits in the last two digits");
  }

  void tell(const Entry& entry, std::string_view rule, std::string message, std::string remedy) {
    if (!findings_->enough_of(rule))
      findings_->add(Severity::warning, std::max(entry.line, 1U), 1, rule, std::move(message),
                     std::move(remedy));
  }

  const Dictionary* dictionary_;
  const Object* object_;
  Findings* findings_;
};

}  // namespace

void check_mandatory_objects(const PresentObjects& present, Findings& findings) {
  struct Row {
    std::uint16_t index;
    std::string_view name;
  };
  for (const auto& row : {Row{0x1000, "device type"}, Row{0x1001, "error register"}, Row{0x1018, "identity"}})
    if (!present.has(row.index))
      findings.add(Severity::warning, 1, 1, "missing-mandatory-object",
                   formatted("{:04X} ({}) is missing: it is mandatory", row.index, row.name),
                   "add its sections");
}

void check_mappings(const Dictionary& dictionary, Findings& findings) {
  for (const auto& object : dictionary.objects()) {
    if (!is_pdo_mapping(object.index)) continue;
    Mapping mapping(dictionary, object, findings);
    mapping.check(&Entry::default_value, "DefaultValue");
    mapping.check(&Entry::configured, "ParameterValue");
  }
}

}  // namespace servoctl::od
