#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "od/eds.hpp"
#include "od/ini.hpp"

namespace servoctl::od {

/// Collects what is wrong in a file. Of each rule the first kMostOfARule are kept; one more stands for all
/// the rest, so that no file makes a report without end and no rule hides another.
class Findings {
 public:
  static constexpr std::uint32_t kMostOfARule = 200;

  void error(const IniKey& key, std::string_view rule, std::string message, std::string remedy);
  void warn(const IniKey& key, std::string_view rule, std::string message, std::string remedy);
  void add(Severity severity, std::uint32_t line, std::uint32_t column, std::string_view rule,
           std::string message, std::string remedy);
  /// One that knows its section and key.
  void add(Diagnostic finding);
  /// Whether the rule has enough findings already. Then the one at hand is counted, and the caller needs no
  /// text for it.
  bool enough_of(std::string_view rule);
  /// Tells of each finding so far in which section and at which key it is.
  void place(const IniText& ini);
  /// In rising line; those that stand for others at the end.
  std::vector<Diagnostic> take();

 private:
  struct Rule {
    Severity severity = Severity::warning;
    std::uint32_t count = 0;
  };
  std::vector<Diagnostic> all_;
  std::map<std::string, Rule, std::less<>> rules_;
};

}  // namespace servoctl::od
