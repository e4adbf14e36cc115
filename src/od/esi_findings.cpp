#include "od/esi_findings.hpp"

#include <array>
#include <utility>

#include "base/format.hpp"
#include "od/eds_value.hpp"

namespace servoctl::od {
namespace {

/// What a reader looks for in the file: `Object 0x2000`, `DataType DT2000`, `RxPdo 0x1600`.
std::string section_of(XmlElement element) {
  constexpr std::array<std::string_view, 6> kSections{"Object", "DataType", "RxPdo", "TxPdo", "Sm", "Device"};
  for (; element; element = element.parent())
    for (const auto section : kSections) {
      if (element.name() != section) continue;
      auto what = element.child("Index").text();
      if (what.empty())
        what = section == "Device" ? element.child("Type").text() : element.child("Name").text();
      if (section == "Sm") what = element.text();
      return what.empty() ? std::string(section) : formatted("{} {}", section, shown(what));
    }
  return {};
}

}  // namespace

void EsiFindings::add(Severity severity, XmlElement at, std::string_view rule, std::string message,
                      std::string remedy) {
  const auto place = at.place();
  if (told_.contains({place.line, place.column, std::string(rule)}) || findings_->enough_of(rule)) return;
  told_.emplace(place.line, place.column, std::string(rule));
  findings_->add({.severity = severity,
                  .line = place.line,
                  .column = place.column,
                  .rule = std::string(rule),
                  .message = std::move(message),
                  .remedy = std::move(remedy),
                  .section = section_of(at),
                  .key = shown(at.name())});
}

}  // namespace servoctl::od
