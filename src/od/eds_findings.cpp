#include "od/eds_findings.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "od/eds_value.hpp"

namespace servoctl::od {

void Findings::add(Severity severity, std::uint32_t line, std::uint32_t column, std::string_view rule,
                   std::string message, std::string remedy) {
  add({severity, line, column, std::string(rule), std::move(message), std::move(remedy)});
}

void Findings::add(Diagnostic finding) {
  if (enough_of(finding.rule)) return;
  auto& known = rules_[finding.rule];
  known.severity = finding.severity;
  ++known.count;
  all_.push_back(std::move(finding));
}

void Findings::error(const IniKey& key, std::string_view rule, std::string message, std::string remedy) {
  add(Severity::error, key.line, key.value_column, rule, std::move(message), std::move(remedy));
}

void Findings::warn(const IniKey& key, std::string_view rule, std::string message, std::string remedy) {
  add(Severity::warning, key.line, key.value_column, rule, std::move(message), std::move(remedy));
}

bool Findings::enough_of(std::string_view rule) {
  const auto known = rules_.find(rule);
  if (known == rules_.end() || known->second.count < kMostOfARule) return false;
  ++known->second.count;
  return true;
}

void Findings::place(const IniText& ini) {
  std::stable_sort(all_.begin(), all_.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.line < b.line; });
  auto section = ini.sections.begin();
  auto key = ini.keys.begin();
  for (auto& finding : all_) {
    while (section != ini.sections.end() && section->line <= finding.line) ++section;
    while (key != ini.keys.end() && key->line < finding.line) ++key;
    if (section != ini.sections.begin()) finding.section = shown((section - 1)->name);
    if (key != ini.keys.end() && key->line == finding.line) finding.key = shown(key->key);
  }
}

std::vector<Diagnostic> Findings::take() {
  std::stable_sort(all_.begin(), all_.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.line < b.line; });
  if (all_.empty()) return {};
  const auto last_line = all_.back().line;
  for (const auto& entry : rules_) {
    const auto& rule = entry.second;
    if (rule.count <= kMostOfARule) continue;
    const auto more = rule.count - kMostOfARule;
    all_.push_back({rule.severity, last_line, 1, entry.first,
                    formatted("{} more of this rule {} left out", more, more == 1 ? "is" : "are"),
                    "correct those that are shown, then check again", more});
  }
  return std::move(all_);
}

}  // namespace servoctl::od
