#include "drive/profile_sheet.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/format.hpp"
#include "drive/file_identity.hpp"
#include "drive/learned_access.hpp"
#include "drive/standard_objects.hpp"
#include "od/data_sheet.hpp"

namespace servoctl::drive {
namespace {

void set_marks(Rules& rules, std::vector<IdentityMark> marks) {
  rules.identity = std::move(marks);
  // A maker's number is his alone (CiA 301, 7.5.2.19); without one, others may answer the same.
  rules.identity_telling =
      std::any_of(rules.identity.begin(), rules.identity.end(),
                  [](const IdentityMark& mark) { return mark.object == objects::kVendorId; });
}

constexpr std::string_view kOutputAssignment = "0x1C12";
constexpr std::string_view kInputAssignment = "0x1C13";

/// What an ESI says of the way to the objects, where the rules do not say it.
void add_layout(Rules& rules, const od::EsiLayout& layout) {
  using Use = od::EsiSyncManager::Use;
  const auto area = [&](Use use) {
    const auto* manager = layout.find(use);
    return manager == nullptr ? EscArea{} : EscArea{manager->start, manager->size};
  };
  if (!layout.coe || rules.coe.exists()) return;
  rules.coe.mailbox_out = area(Use::mailbox_out);
  rules.coe.mailbox_in = area(Use::mailbox_in);
  rules.coe.outputs = area(Use::outputs).start;
  rules.coe.inputs = area(Use::inputs).start;
  rules.coe.sdo_info = layout.sdo_info;
  rules.coe.complete_access = layout.complete_access;
  rules.pdo.assign_rpdo = kOutputAssignment;
  rules.pdo.assign_tpdo = kInputAssignment;
}

Result<od::EdsFile> read_sheet(Profile& profile, const std::string& word) {
  const auto text = od::read_sheet_file(word);
  if (!text) return fail(text.error());
  if (!od::is_xml(*text)) return od::read_eds(*text, word);
  const auto name = od::sheet_name(word);
  auto esi = od::read_esi(*text, name.path, name.device);
  if (!esi) return fail(esi.error());
  add_layout(profile.rules, esi->layout);
  return std::move(esi->sheet);
}

}  // namespace

bool is_drive(const od::Dictionary& dictionary) {
  return dictionary.find(objects::kControlword) != nullptr &&
         dictionary.find(objects::kStatusword) != nullptr;
}

void take_sheet(Profile& profile, od::EdsFile& file) {
  if (profile.rules.identity.empty()) set_marks(profile.rules, identity_marks(file));
  profile.unknown_access = unknown_access(file, profile.dictionary);
  if (is_drive(file.dictionary)) od::inherit(file.dictionary, profile.dictionary);
  profile.dictionary = std::move(file.dictionary);
  profile.notes = std::move(file.notes);
  profile.configured_node = file.node_id;
  if (profile.rules.name.empty()) profile.rules.name = file.device.product_name;
  if (profile.rules.vendor.empty()) profile.rules.vendor = file.device.vendor_name;
}

Result<void> add_sheet(Profile& profile, const std::string& word) {
  auto file = read_sheet(profile, word);
  if (!file) return fail(file.error());
  take_sheet(profile, *file);
  profile.data_sheet = word;
  if (auto findings = findings_text(*file, word); !findings.empty())
    profile.warnings.push_back(std::move(findings));
  return {};
}

std::string findings_text(const od::EdsFile& sheet, std::string_view word) {
  const auto errors = sheet.error_count();
  const auto warnings = sheet.warning_count();
  if (errors + warnings == 0) return {};
  if (errors + warnings > 1)
    return formatted("{0}: {1} errors and {2} warnings; `eds check {0}` lists them", word, errors, warnings);
  return errors == 1 ? formatted("{0}: 1 error; `eds check {0}` shows it", word)
                     : formatted("{0}: 1 warning; `eds check {0}` shows it", word);
}

}  // namespace servoctl::drive
