#include "od/esi_checks.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "base/format.hpp"

namespace servoctl::od {
namespace {

void tell_layout(Findings& findings, std::uint32_t line, std::string_view rule, std::string section,
                 std::string message, std::string remedy) {
  if (findings.enough_of(rule)) return;
  findings.add({.severity = Severity::warning,
                .line = std::max(line, 1U),
                .column = 1,
                .rule = std::string(rule),
                .message = std::move(message),
                .remedy = std::move(remedy),
                .section = std::move(section)});
}

std::string pdo_name(const EsiPdo& pdo) {
  return formatted("{} 0x{:04X}", pdo.direction == PdoDirection::receive ? "RxPdo" : "TxPdo", pdo.index);
}

/// Bits of an entry in a PDO; 0 where they vary.
std::size_t mapped_bits(const Entry& entry, const BitSizes& sizes) {
  const auto own = sizes.find(entry.address);
  if (own != sizes.end()) return own->second;
  return entry.type == DataType::boolean ? 1 : 8 * size_of(entry.type).value_or(0);
}

void check_pdo(const EsiPdo& pdo, const Dictionary& dictionary, const BitSizes& sizes, Findings& findings) {
  for (const auto& from : pdo.entries) {
    if (from.object.index == 0) continue;  // Fills a gap.
    const auto* entry = dictionary.find(from.object);
    if (entry == nullptr) {
      tell_layout(
          findings, from.line, "mapping-absent", pdo_name(pdo),
          formatted("{} maps {}, which the dictionary does not have", pdo_name(pdo), to_string(from.object)),
          "map another object, or add it to Objects");
      continue;
    }
    const auto bits = mapped_bits(*entry, sizes);
    const bool padded = entry->type == DataType::boolean && from.bits == 8;
    if (bits != 0 && bits != from.bits && !padded)
      tell_layout(findings, from.line, "mapping-length", pdo_name(pdo),
                  formatted("{} maps {} bits of {}, which has {}", pdo_name(pdo), from.bits,
                            to_string(from.object), bits),
                  formatted("write BitLen {}", bits));
  }
}

void check_process_data(const EsiLayout& layout, Findings& findings) {
  for (std::size_t number = 0; number < layout.sync_managers.size(); ++number) {
    const auto& manager = layout.sync_managers[number];
    const bool outputs = manager.use == EsiSyncManager::Use::outputs;
    if ((!outputs && manager.use != EsiSyncManager::Use::inputs) || manager.size == 0) continue;
    std::size_t bits = 0;
    bool any = false;
    for (const auto& pdo : layout.pdos)
      if (pdo.sync_manager == number) {
        any = true;
        bits += pdo.bits();
      }
    const auto bytes = (bits + 7) / 8;
    if (any && bytes != manager.size)
      tell_layout(findings, manager.line, "sync-manager-size",
                  formatted("Sm {}", outputs ? "Outputs" : "Inputs"),
                  formatted("DefaultSize is {} bytes, but the PDOs assigned to sync manager {} have {}",
                            manager.size, number, bytes),
                  formatted("write DefaultSize {}, or assign other PDOs", bytes));
  }
}

void check_mailboxes(const EsiLayout& layout, std::uint32_t device_line, Findings& findings) {
  for (const auto use : {EsiSyncManager::Use::mailbox_out, EsiSyncManager::Use::mailbox_in}) {
    const auto* manager = layout.find(use);
    const auto section =
        use == EsiSyncManager::Use::mailbox_out ? std::string("MBoxOut") : std::string("MBoxIn");
    if (manager == nullptr) {
      if (layout.coe)
        tell_layout(findings, device_line, "missing-mailbox", {},
                    formatted("the device speaks CoE, but has no Sm {}", section),
                    "add it, with StartAddress and DefaultSize");
      continue;
    }
    if ((manager->least && manager->size < *manager->least) ||
        (manager->most && manager->size > *manager->most))
      tell_layout(findings, manager->line, "mailbox-size", "Sm " + section,
                  formatted("DefaultSize {} is not within MinSize {} and MaxSize {}", manager->size,
                            manager->least.value_or(0), manager->most.value_or(0xFFFF)),
                  "correct one of them");
  }
}

void check_mandatory(const EsiFile& file, Findings& findings) {
  for (const auto& [index, name] : {std::pair(0x1000, "device type"), std::pair(0x1018, "identity")})
    if (file.sheet.dictionary.object(static_cast<std::uint16_t>(index)) == nullptr)
      tell_layout(findings, file.device.line, "missing-mandatory-object", {},
                  formatted("{:04X} ({}) is missing: it is mandatory", index, name), "add it to Objects");
}

}  // namespace

void check_esi_layout(const EsiFile& file, const BitSizes& sizes, bool has_dictionary, Findings& findings) {
  if (has_dictionary) {
    check_mandatory(file, findings);
    for (const auto& pdo : file.layout.pdos) check_pdo(pdo, file.sheet.dictionary, sizes, findings);
  }
  check_process_data(file.layout, findings);
  check_mailboxes(file.layout, file.device.line, findings);
}

void settle_esi_identity(EsiFile& file, Findings& findings) {
  struct Row {
    std::uint8_t sub;
    std::string_view name;
    std::uint32_t device;
  };
  const auto& device = file.sheet.device;
  for (const auto& row :
       {Row{1, "vendor", device.vendor_number}, Row{2, "product code", device.product_number},
        Row{3, "revision", device.revision_number}}) {
    auto* entry = file.sheet.dictionary.find({0x1018, row.sub});
    if (entry == nullptr || entry->type != DataType::u32 || !entry->default_value || row.device == 0)
      continue;
    const auto said = std::get_if<std::uint64_t>(&entry->default_value->value);
    const auto number = said != nullptr ? *said : 0;
    if (number == row.device) continue;
    entry->default_value = NodeValue{Value(std::uint64_t{row.device}), false};
    if (number != 0)
      tell_layout(
          findings, entry->line, "identity-differs", "Object #x1018",
          formatted("0x1018:{} says the {} is 0x{:08X}, the device says 0x{:08X}; the device's is taken",
                    row.sub, row.name, number, row.device),
          "correct one of them");
  }
}

}  // namespace servoctl::od
