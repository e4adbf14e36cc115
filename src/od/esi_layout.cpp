#include "od/esi_layout.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "od/eds_value.hpp"
#include "od/esi_types.hpp"
#include "od/esi_value.hpp"

namespace servoctl::od {
namespace {

constexpr std::size_t kMostPdos = 1024;
constexpr std::size_t kMostManagers = 64;     ///< A controller has 16 at most.
constexpr std::size_t kMostPdoEntries = 254;  ///< Sub-indices a mapping has for them.

EsiSyncManager::Use use_of(std::string_view text) {
  using Use = EsiSyncManager::Use;
  constexpr std::array kUses{std::pair("MBoxOut", Use::mailbox_out), std::pair("MBoxIn", Use::mailbox_in),
                             std::pair("Outputs", Use::outputs), std::pair("Inputs", Use::inputs)};
  for (const auto& [word, use] : kUses)
    if (equals_nocase(word, text)) return use;
  return Use::other;
}

EsiSyncManager sync_manager_of(XmlElement element, EsiFindings& findings) {
  const auto size = [&](const char* name) {
    return static_cast<std::uint16_t>(esi_attribute(element, name, 0xFFFF, findings));
  };
  EsiSyncManager out;
  out.use = use_of(element.text());
  out.start = size("StartAddress");
  out.size = size("DefaultSize");
  if (!element.attribute("MinSize").empty()) out.least = size("MinSize");
  if (!element.attribute("MaxSize").empty()) out.most = size("MaxSize");
  out.control = static_cast<std::uint8_t>(esi_attribute(element, "ControlByte", 0xFF, findings));
  out.enabled = element.attribute("Enable") != "0";
  out.line = element.place().line;
  return out;
}

EsiPdoEntry pdo_entry_of(XmlElement element, EsiFindings& findings) {
  EsiPdoEntry out;
  out.object.index = static_cast<std::uint16_t>(esi_number(element.child("Index"), 0xFFFF, findings));
  out.object.sub = static_cast<std::uint8_t>(esi_number(element.child("SubIndex"), 0xFF, findings));
  out.bits = static_cast<std::uint8_t>(esi_number(element.child("BitLen"), 0xFF, findings));
  auto name = esi_text(element, "Name");
  out.name = std::move(name.english);
  out.name_zh = std::move(name.chinese);
  if (const auto type = esi_base_type(element.child("DataType").text())) out.type = type->type;
  out.line = element.place().line;
  return out;
}

EsiPdo pdo_of(XmlElement element, PdoDirection direction, EsiFindings& findings) {
  EsiPdo out;
  out.direction = direction;
  out.index = static_cast<std::uint16_t>(esi_number(element.child("Index"), 0xFFFF, findings));
  out.name = esi_text(element, "Name").english;
  out.fixed = esi_flag(element.attribute("Fixed"));
  out.mandatory = esi_flag(element.attribute("Mandatory"));
  if (!element.attribute("Sm").empty())
    out.sync_manager = static_cast<std::uint8_t>(esi_attribute(element, "Sm", 0xFF, findings));
  out.line = element.place().line;
  for (const auto& entry : element.children("Entry")) {
    if (out.entries.size() == kMostPdoEntries) {
      findings.error(entry, "too-many-entries", formatted("a PDO has at most {} entries", kMostPdoEntries),
                     "remove those beyond");
      break;
    }
    out.entries.push_back(pdo_entry_of(entry, findings));
  }
  return out;
}

void read_pdos(XmlElement device, EsiLayout& out, EsiFindings& findings) {
  for (const auto direction : {PdoDirection::receive, PdoDirection::transmit})
    for (const auto& element : device.children(direction == PdoDirection::receive ? "RxPdo" : "TxPdo")) {
      if (out.pdos.size() == kMostPdos) return;
      auto read = pdo_of(element, direction, findings);
      const bool twice = std::any_of(out.pdos.begin(), out.pdos.end(),
                                     [&](const EsiPdo& p) { return p.index == read.index; });
      if (twice)
        findings.error(element, "duplicate-pdo",
                       formatted("0x{:04X} appears again; the first one is used", read.index),
                       "remove one of them");
      else
        out.pdos.push_back(std::move(read));
    }
}

std::int64_t nanoseconds(XmlElement element) { return esi_signed(element.text()).value_or(0); }

void read_modes(XmlElement clocks, EsiLayout& out, EsiFindings& findings) {
  for (const auto& element : clocks.children("OpMode", kMostManagers)) {
    EsiOpMode mode;
    mode.name = std::string(element.child("Name").text());
    mode.description = std::string(element.child("Desc").text());
    mode.assign_activate =
        static_cast<std::uint16_t>(esi_number(element.child("AssignActivate"), 0xFFFF, findings));
    mode.cycle_sync0 = nanoseconds(element.child("CycleTimeSync0"));
    mode.shift_sync0 = nanoseconds(element.child("ShiftTimeSync0"));
    out.modes.push_back(std::move(mode));
  }
}

}  // namespace

std::size_t EsiPdo::bits() const {
  std::size_t out = 0;
  for (const auto& entry : entries) out += entry.bits;
  return out;
}

const EsiSyncManager* EsiLayout::find(EsiSyncManager::Use use) const {
  const auto found = std::find_if(sync_managers.begin(), sync_managers.end(),
                                  [&](const EsiSyncManager& manager) { return manager.use == use; });
  return found == sync_managers.end() ? nullptr : &*found;
}

EsiLayout read_esi_layout(XmlElement device, EsiFindings& findings) {
  EsiLayout out;
  for (const auto& element : device.children("Sm", kMostManagers))
    out.sync_managers.push_back(sync_manager_of(element, findings));
  for (const auto& element : device.children("Fmmu", kMostManagers)) out.fmmus.emplace_back(element.text());
  read_pdos(device, out, findings);
  if (const auto coe = device.child("Mailbox").child("CoE")) {
    out.coe = true;
    out.sdo_info = esi_flag(coe.attribute("SdoInfo"));
    out.pdo_assign = esi_flag(coe.attribute("PdoAssign"));
    out.pdo_config = esi_flag(coe.attribute("PdoConfig"));
    out.complete_access = esi_flag(coe.attribute("CompleteAccess"));
  }
  read_modes(device.child("Dc"), out, findings);
  out.eeprom_bytes = esi_number(device.child("Eeprom").child("ByteSize"), 0xFFFF'FFFF, findings);
  return out;
}

}  // namespace servoctl::od
