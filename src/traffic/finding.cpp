#include "traffic/finding.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "session/own_bitrate.hpp"

namespace servoctl::traffic {

using report::Show;
using report::Value;

Finding two_nodes(std::uint8_t node, std::string_view noticed) {
  return {
      Finding::Level::fault, "duplicate-node", formatted("two nodes have the number {}: {}", node, noticed),
      "both obey what is meant for one",
      formatted(
          "switch all but one of them off and give it another number: `address NEW -n {} -d FAMILY`; drives with LSS "
          "take one by their serial numbers while both are on: `help lss set-node`",
          node)};
}

std::string bitrate_search(std::string_view url) {
  if (!url.empty() && session::check_own_bitrate(url, "bus detect"))
    return formatted("`bus detect {}` finds the bitrate", url);
  return "`bus detect INTERFACE` on the machine that has the interface finds the bitrate";
}

std::string_view name(Finding::Level level) {
  switch (level) {
    case Finding::Level::ok: return "ok";
    case Finding::Level::note: return "note";
    case Finding::Level::fault: return "fault";
  }
  return {};
}

std::size_t faults_in(const std::vector<Findings>& all) {
  std::size_t out = 0;
  for (const auto& findings : all)
    out +=
        static_cast<std::size_t>(std::count_if(findings.list.begin(), findings.list.end(), [](const auto& f) {
          return f.level == Finding::Level::fault;
        }));
  return out;
}

report::Value findings_value(const std::vector<Findings>& all) {
  report::Table table;
  table.columns = {{"bus"}, {"level"}, {"finding"}};
  for (const auto& findings : all) {
    for (const auto& f : findings.list) {
      table.rows.push_back({findings.bus, name(f.level), f.text});
      if (!f.means.empty()) table.rows.push_back({"", "", "  " + f.means});
      if (!f.mend.empty()) table.rows.push_back({"", "", "  mend: " + f.mend});
      table.documents.emplace_back(report::Record{{"bus", report::text_or_null(findings.bus)},
                                                  {"level", name(f.level)},
                                                  {"code", f.code},
                                                  {"text", f.text},
                                                  {"means", report::text_or_null(f.means)},
                                                  {"mend", report::text_or_null(f.mend)}});
    }
  }
  return Value(std::move(table));
}

}  // namespace servoctl::traffic
