#include "show/fault_records.hpp"

#include "base/format.hpp"
#include "base/text.hpp"
#include "canopen/emergency.hpp"
#include "drive/cia402.hpp"
#include "report/catalogue.hpp"
#include "show/records.hpp"

namespace servoctl::show {
namespace {

using report::Show;
using report::Value;

std::string code_text(const drive::Fault& fault) {
  return fault.code ? formatted("0x{:04X}", *fault.code) : std::string();
}

std::string name_of(const drive::Fault& fault, bool chinese) {
  return chinese && !fault.name_zh.empty() ? fault.name_zh : fault.name;
}

/// Of a code that the family does not list: what its parents say, most often CiA 402; else the class of CiA
/// 301.
std::string unlisted_words(const drive::Profile& profile, bool chinese, std::uint16_t code) {
  const auto* fault = profile.parent_fault(code);
  if (fault == nullptr) return canopen::emergency_text(code);
  return formatted("{} (not among the faults of {})", name_of(*fault, chinese), profile.family);
}

}  // namespace

report::Table fault_table(std::span<const drive::Fault* const> faults, bool chinese) {
  report::Table table;
  table.columns = {{"code_text", "code", Show::text},
                   {"code", "", Show::json},
                   {"extra", "", Show::json},
                   {"panel"},
                   {"kind"},
                   {"name_text", "name", Show::text},
                   {"name", "", Show::json},
                   {"name_zh", "", Show::json},
                   {"resettable"},
                   {"check_text", "check", Show::text},
                   {"check", "", Show::json},
                   {"check_zh", "", Show::json},
                   {"mark", "?!", Show::text},
                   {"assumed", "", Show::json},
                   {"assumed_fields", "", Show::json},
                   {"contradicted", "", Show::json},
                   {"contradicted_fields", "", Show::json}};
  for (const auto* f : faults) {
    const auto check = chinese && !f->check_zh.empty() ? f->check_zh : f->check;
    table.rows.push_back({code_text(*f), f->code ? Value(*f->code) : Value(), report::text_or_null(f->extra),
                          report::text_or_null(f->panel), drive::name(f->kind), name_of(*f, chinese), f->name,
                          report::text_or_null(f->name_zh), f->resettable ? Value(*f->resettable) : Value(),
                          check, report::text_or_null(f->check), report::text_or_null(f->check_zh),
                          f->doubts.sign(), !f->doubts.assumed.empty(), marks_record(f->doubts.assumed),
                          !f->doubts.contradicted.empty(), marks_record(f->doubts.contradicted)});
  }
  explain_marks(table);
  return table;
}

report::Record fault_record(const drive::Fault& fault, bool chinese) {
  const auto& check = chinese && !fault.check_zh.empty() ? fault.check_zh : fault.check;
  const auto power_cycle = std::string("no, it needs a power cycle");
  report::Record out{
      {"code_text", report::text_or_null(code_text(fault)), Show::text, "code"},
      {"code", fault.code ? Value(*fault.code) : Value(), Show::json},
      {"extra", report::text_or_null(fault.extra)},
      {"panel", report::text_or_null(fault.panel)},
      {"kind", drive::name(fault.kind)},
      {"name_text", name_of(fault, chinese), Show::text, "name"},
      {"name", fault.name, Show::json},
      {"name_zh", report::text_or_null(fault.name_zh), Show::json},
      {"resettable_text",
       !fault.resettable   ? Value()
       : *fault.resettable ? Value("yes")
                           : Value(power_cycle),
       Show::text, "resettable"},
      {"resettable", fault.resettable ? Value(*fault.resettable) : Value(), Show::json},
      {"check_text", report::text_or_null(check), Show::text, "check"},
      {"check", report::text_or_null(fault.check), Show::json},
      {"check_zh", report::text_or_null(fault.check_zh), Show::json},
  };
  for (auto& field : doubts_record(fault.doubts)) out.push_back(std::move(field));
  return out;
}

std::string alarm_words(const drive::Profile* profile, bool chinese, std::uint16_t code) {
  constexpr std::string_view kUnlisted = "not listed in the manual";
  if (profile == nullptr || drive::faults_of(profile->faults, profile->rules.emergency, code, {}).empty())
    return std::string(chinese ? report::chinese_word(kUnlisted) : kUnlisted);
  return fault_words(profile, chinese, code);
}

std::string fault_words(const drive::Profile* profile, bool chinese, std::uint16_t code,
                        const std::array<std::uint8_t, 5>& vendor) {
  if (profile == nullptr) return canopen::emergency_text(code);
  const auto found = drive::faults_of(profile->faults, profile->rules.emergency, code, vendor);
  if (found.empty()) return unlisted_words(*profile, chinese, code);
  if (found.size() == 1) {
    const auto& fault = *found.front();
    return (fault.panel.empty() ? "" : fault.panel + " ") + name_of(fault, chinese);
  }
  std::string panels;
  for (const auto* fault : found)
    append(panels, (fault->panel.empty() ? name_of(*fault, chinese) : fault->panel));
  return formatted("one of {} alarms: {}", found.size(), panels);
}

report::Value ToldFault::cell(std::size_t most) const {
  if (!known) return {};
  if (text.empty()) return "none";
  if (!code) return "in fault, no code in 603Fh: `fault show`";
  const auto number = formatted("0x{:04X}", *code);
  return most == 0 ? number : number + " " + clip(text, most);
}

report::Value ToldFault::record() const {
  if (text.empty()) return {};
  return report::Record{{"code", code ? report::Value(*code) : report::Value()}, {"text", text}};
}

constexpr std::string_view kNoCode = "the drive is in fault and tells no code (603Fh)";

ToldFault told_fault(const drive::Profile* profile, bool chinese, std::optional<std::uint16_t> code,
                     std::optional<std::uint16_t> statusword) {
  const auto state = statusword ? std::optional(drive::decode_state(*statusword)) : std::nullopt;
  const bool in_fault =
      state == drive::DriveState::fault || state == drive::DriveState::fault_reaction_active;
  if (code.value_or(0) != 0) return {true, code, fault_words(profile, chinese, *code)};
  if (in_fault) return {true, std::nullopt, std::string(chinese ? report::chinese_word(kNoCode) : kNoCode)};
  return {code.has_value(), code, {}};
}

}  // namespace servoctl::show
