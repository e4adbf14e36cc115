#include "base/format.hpp"
#include "show/explanation_parts.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/folded.hpp"
#include "report/catalogue.hpp"
#include "show/fault_records.hpp"
#include "show/printed_number.hpp"

namespace servoctl::show {
namespace {

Explanation of_faults(const drive::Profile& profile, const std::vector<const drive::Fault*>& faults,
                      bool chinese) {
  const auto& first = *faults.front();
  const auto code = first.code ? formatted("0x{:04X}", *first.code) : std::string();
  const auto name = !first.panel.empty() ? first.panel : code.empty() ? first.name : code;
  if (faults.size() == 1) {
    const auto title_zh = first.name_zh.empty() ? std::string() : name + " " + first.name_zh;
    auto topic = topic_heading(profile.family, "fault", name, name + " " + first.name, title_zh);
    topic.line = source_of_line(first.line);
    return {std::move(topic), Found::fault, {}, fault_record(first, chinese)};
  }
  auto shared = formatted("{}: {} faults share this code", code, faults.size());
  auto shared_zh = report::in_chinese(shared);
  return {topic_heading(profile.family, "fault", code, std::move(shared), std::move(shared_zh)),
          Found::fault,
          {},
          fault_table(faults, chinese)};
}

/// A code that the family does not list, most often one of CiA 402.
void add_parent_fault(const drive::Profile& profile, std::uint64_t code, bool chinese,
                      std::vector<Explanation>& out) {
  constexpr std::string_view kNote =
      "Not among the faults of {}: from CiA 402, or the family that it is based on.";
  const auto* fault = profile.parent_fault(static_cast<std::uint16_t>(code));
  if (fault == nullptr) return;
  out.push_back(of_faults(profile, {fault}, chinese));
  auto& topic = out.back().topic;
  topic.note = formatted(kNote, profile.family);
  topic.note_zh = formatted(fmt::runtime(report::chinese_word(kNote)), profile.family);
  topic.line.clear();
}

/// As people write what a panel shows: `AL09` for `AL.09`.
std::string without_signs(std::string_view panel) {
  std::string out(panel);
  std::erase_if(out, [](char c) { return c == '.' || c == '-'; });
  return out;
}

}  // namespace

void add_faults(const TopicQuery& query, const drive::Profile& profile, bool by_name_only, bool chinese,
                std::vector<Explanation>& out) {
  constexpr std::size_t kDigits = 4;
  constexpr std::size_t kTellingCode = 3;
  const bool may_be_code = query.whole().size() >= kDigits && !by_name_only;
  const auto code = code_in(may_be_code ? query.whole() : std::string_view(), kDigits);
  std::vector<const drive::Fault*> of_code;
  std::vector<const drive::Fault*> named;
  for (const auto& fault : profile.faults) {
    const bool second = fault.extra.size() >= kTellingCode && query.names(fault.extra);
    const bool called = query.names(fault.panel) || query.names_display(fault.panel) || second ||
                        (!by_name_only && (query.names(fault.name) || query.names(fault.name_zh)));
    const bool of_its_code = !called && code && fault.code == code;
    if (called) named.push_back(&fault);
    if (of_its_code) of_code.push_back(&fault);
    if (called || of_its_code || by_name_only) continue;
    const bool titled = query.mentions(searchable({fault.name, fault.name_zh}));
    if (!titled && !query.mentions(searchable({fault.name, fault.name_zh, fault.check, fault.check_zh})))
      continue;
    out.push_back(of_faults(profile, {&fault}, chinese));
    out.back().found = titled ? Found::title : Found::text;
  }
  if (named.empty())
    for (const auto& fault : profile.faults)
      if (!fault.panel.empty() && query.names(without_signs(fault.panel))) named.push_back(&fault);
  for (const auto* fault : named) out.push_back(of_faults(profile, {fault}, chinese));
  if (of_code.size() > kFewFaults) {
    out.push_back(of_faults(profile, of_code, chinese));
  } else {
    for (const auto* fault : of_code) out.push_back(of_faults(profile, {fault}, chinese));
  }
  if (code && named.empty() && of_code.empty()) add_parent_fault(profile, *code, chinese, out);
}

void add_counted_faults(std::string_view number, const Library& library, bool chinese,
                        std::vector<Explanation>& out) {
  if (library.by_name_only) return;
  for (const auto& fault : library.profile->faults)
    if (is_counted_by(folded(fault.panel), folded(number)))
      out.push_back(of_faults(*library.profile, {&fault}, chinese));
}

}  // namespace servoctl::show
