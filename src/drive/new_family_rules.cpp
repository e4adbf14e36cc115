// The rules file of a family that is made from a data sheet.
#include <algorithm>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "drive/file_identity.hpp"
#include "drive/new_family.hpp"
#include "drive/profile_sheet.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::drive {
namespace {

/// What would move the cursor or hide is written out.
std::string printable_toml(std::string_view text) { return toml_text(printable(text)); }

std::string mark_text(const IdentityMark& mark) {
  const auto object = formatted("0x{:04X}:{:02X}", mark.object.index, mark.object.sub);
  const std::string_view soft = mark.soft ? ", soft = true" : "";
  return mark.text.empty()
             ? formatted("{{ object = \"{}\", value = 0x{:08X}{} }}", object, mark.value, soft)
             : formatted("{{ object = \"{}\", text = {}{} }}", object, printable_toml(mark.text), soft);
}

std::string head(const od::EdsFile& sheet, std::string_view source, const NewFamily& family) {
  const auto& device = sheet.device;
  return formatted(
      "# Made from {} by `servoctl drives new`. Every line that begins with \"# Decide\" needs a person with the\n"
      "# manual; docs/drive-data.md describes all keys. After each change: servoctl drives check {}\n"
      "format = 1\nfamily = \"{}\"\nparent = \"cia402\"\nvendor = {}\nname = {}\n"
      "# name_zh = \"\"\n",
      printable(source), family.name, family.name,
      printable_toml(device.vendor_name.empty() ? "unknown" : device.vendor_name),
      printable_toml(device.product_name.empty() ? family.name : device.product_name));
}

std::string identity(const od::EdsFile& sheet, NewFamily& family) {
  auto marks = identity_marks(sheet);
  // What the dictionary does not have, the drive cannot answer. The file of an EtherCAT device may have none.
  if (!sheet.ethercat)
    std::erase_if(marks, [&](const auto& mark) { return sheet.dictionary.find(mark.object) == nullptr; });
  if (marks.empty()) {
    family.open.emplace_back("[identity]");
    return "\n# Decide: the data sheet has no identity, so nothing proves the family. `servoctl info -n NODE`\n"
           "# shows what the drive answers.\n"
           "# [identity]\n# certain = true\n# match = [{ object = \"0x1018:01\", value = 0x00000000 }]\n";
  }
  std::string out =
      "\n# What the drive must answer; with other values nothing is written to it under this name.\n";
  out +=
      "# Decide: set certain to true only if no other drive answers the same: then -d need not be given.\n";
  out += "[identity]\ncertain = false\nmatch = [\n";
  family.open.emplace_back("[identity] certain");
  for (const auto& mark : marks) {
    out += "  " + mark_text(mark) + ",\n";
    family.identity.push_back(mark.text.empty()
                                  ? formatted("{} = 0x{:08X}", to_string(mark.object), mark.value)
                                  : formatted("{} = {}", to_string(mark.object), mark.text));
  }
  return out + "]\n";
}

std::string storing(const od::EdsFile& sheet, NewFamily& family) {
  const bool objects = sheet.dictionary.object(objects::kStoreIndex) != nullptr;
  family.open.emplace_back("[store] wears");
  std::string out =
      objects
          ? "\n# The data sheet has 1010h: `store` uses it.\n"
          : "\n# The data sheet has no 1010h.\n# Decide: if a parameter stores, name it: store = [{ name = \"P1-01\", "
            "value = 1 }]\n";
  if (!objects) family.open.emplace_back("[store] store");
  out += formatted("[store]\nobjects = {}\n", objects);
  return out +
         "# Decide: true if the drive keeps every write in its flash at once (each one wears it).\n# wears = true\n";
}

std::string open_access(std::string_view source, NewFamily& family) {
  family.open.emplace_back("access of the maker's objects");
  return formatted(
      "\n# Decide: {} was learned from a drive, and does not know which objects can be written. Where the manual\n"
      "# says so, change AccessType to rw in the .eds beside this file; until then servoctl does not write them.\n",
      printable(source));
}

std::string motion(const od::EdsFile& sheet, NewFamily& family) {
  const auto* modes = sheet.dictionary.find(objects::kSupportedModes);
  const bool told = modes != nullptr && modes->default_value;
  std::string out = "\n# Modes, ramps and units are those of CiA 402 (parent).";
  out += told ? formatted(" 6502h in the data sheet: 0x{:X}.\n",
                          static_cast<std::uint64_t>(od::to_double(modes->default_value->value)))
              : std::string(" The data sheet does not give 6502h (supported modes).\n");
  family.open.emplace_back("[motion]");
  family.open.emplace_back("[[caution]]");
  return out +
         "# Decide: false if bit 8 of the controlword (halt) does nothing, or if bit 4 starts no set-point.\n"
         "# [motion]\n# halt = false\n# handshake = false\n"
         "\n# Decide: what somebody has to know before the motor turns; shown before each motion.\n"
         "# [[caution]]\n# name = \"P1-01\"\n# value = 0\n# text = \"P1-01 = 0: the limit switches are ignored.\"\n";
}

}  // namespace

std::string rules_of_sheet(const od::EdsFile& sheet, std::string_view source, NewFamily& family) {
  auto out = head(sheet, source, family) + identity(sheet, family) + storing(sheet, family);
  if (sheet.learned) out += open_access(source, family);
  if (is_drive(sheet.dictionary)) out += motion(sheet, family);
  return out;
}

}  // namespace servoctl::drive
