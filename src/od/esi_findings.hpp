#pragma once

#include <set>
#include <string>
#include <string_view>
#include <tuple>

#include "od/eds_findings.hpp"
#include "od/xml.hpp"

namespace servoctl::od {

/// What is wrong in an ESI: at an element, within the object, type or PDO that it belongs to. What is wrong
/// in a type is told once, however many objects are of it.
class EsiFindings {
 public:
  explicit EsiFindings(Findings& findings) : findings_(&findings) {}

  void error(XmlElement at, std::string_view rule, std::string message, std::string remedy) {
    add(Severity::error, at, rule, std::move(message), std::move(remedy));
  }
  void warn(XmlElement at, std::string_view rule, std::string message, std::string remedy) {
    add(Severity::warning, at, rule, std::move(message), std::move(remedy));
  }
  /// As Findings::enough_of().
  bool enough_of(std::string_view rule) { return findings_->enough_of(rule); }
  Findings& all() { return *findings_; }

 private:
  void add(Severity severity, XmlElement at, std::string_view rule, std::string message, std::string remedy);

  Findings* findings_;
  std::set<std::tuple<std::uint32_t, std::uint32_t, std::string>> told_;
};

}  // namespace servoctl::od
