#include "trial/drive_report.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "report/catalogue.hpp"
#include "report/chinese_marks.hpp"
#include "report/chinese_value.hpp"
#include "trial/report_head.hpp"
#include "trial/verdict.hpp"

namespace servoctl::trial {
namespace {

using report::List;
using report::Record;
using report::Show;
using report::TestResult;
using report::Value;

constexpr int kReportVersion = 2;  ///< 1 was of one bus and one family.

/// Those that say something.
std::string joined(const std::vector<std::string>& texts, std::string_view separator) {
  std::string out;
  for (const auto& text : texts)
    if (!text.empty()) append(out, text, separator);
  return out;
}

/// In the language of the desk.
std::string joined_remarks(const show::Desk& desk, std::vector<std::string> remarks) {
  if (desk.chinese)
    for (auto& remark : remarks) remark = report::in_chinese(remark);
  return joined(remarks, desk.chinese ? "。" : ". ");
}

Value told(const show::Desk& desk, Value value) {
  return desk.chinese ? report::chinese_value(std::move(value)) : value;
}

std::string test_name(const show::Desk& desk, const std::string& test) {
  if (!desk.chinese) return test;
  return report::chinese_marks(formatted("{} ({})", report::in_chinese(test + " test"), test));
}

/// `Bus main (can0)`
std::string title_of(const BusReport& bus) {
  return bus.name == bus.url ? formatted("{} {}", bus.found.title, bus.url)
                             : formatted("{} {} ({})", bus.found.title, bus.name, bus.url);
}

/// What tells the drive from those of other buses and families; empty where there are none.
std::string place_of(const Report& report, const DriveReport& drive) {
  return joined({report.is_of_several(&DriveReport::bus) ? drive.bus_name : std::string(),
                 report.is_of_several(&DriveReport::family) ? drive.family : std::string()},
                ", ");
}

/// Name and verdict are the heading.
report::Page::Section test_section(const show::Desk& desk, const TestResult& test) {
  auto record = verdict_record(desk, test, Show::everywhere);
  std::erase_if(record, [](const report::Field& field) {
    return field.key == "test" || field.key == "node" || field.key == "verdict";
  });
  const Value origin(test.origin);
  if (const auto* time = report::find(origin, "time"))
    record.insert(record.begin(), {"time", *time, Show::text, say(desk, "tested at")});
  return {report::chinese_marks(formatted("{}: {}", test_name(desk, test.test),
                                          passed(test) ? say(desk, "passed") : say(desk, "FAILED"))),
          4, told(desk, std::move(record))};
}

}  // namespace

bool Report::is_of_several(std::string DriveReport::*what) const {
  return std::any_of(drives.begin(), drives.end(),
                     [&](const DriveReport& drive) { return drive.*what != drives.front().*what; });
}

std::string report_page(const show::Desk& desk, const Report& report) {
  const auto& cover = report.cover;
  const Value head(report.head);
  const auto time = std::get<std::string>(report::find(head, "time")->data());
  report::Page page{.chinese = desk.chinese, .title = cover.title};
  if (desk.chinese) page.translate = [](std::string_view heading) { return report::in_chinese(heading); };
  page.picture = cover.logo.uri();
  page.signatures = cover.signatures;
  constexpr std::size_t kFootName = 36;  // Columns: both and the time fit into one line.
  page.foot = joined({clip(cover.customer, kFootName), clip(cover.machine, kFootName), time},
                     desk.chinese ? "，" : ", ");
  page.sections.push_back({say(desk, "Summary"), 2, told(desk, report.head)});
  page.sections.push_back({say(desk, "Drives"), 2, told(desk, drive_table(desk, report))});
  for (const auto& bus : report.buses)
    page.sections.push_back({report.buses.size() < 2 ? bus.found.title : title_of(bus), 2,
                             told(desk, List{bus.link, bus.found.value}),
                             joined_remarks(desk, bus.found.remarks)});
  for (const auto& drive : report.drives) {
    page.sections.push_back(
        {drive.title,
         2,
         {},
         joined({cover.machine, place_of(report, drive), time}, desk.chinese ? "，" : ", "),
         true});
    for (const auto& part : drive.parts)
      page.sections.push_back({part.title, 3, told(desk, part.value), joined_remarks(desk, part.remarks)});
    if (!drive.tests.empty()) page.sections.push_back({say(desk, "Tests"), 3});
    for (const auto& test : drive.tests) page.sections.push_back(test_section(desk, test));
  }
  return report::html_page(page);
}

std::string report_json(const show::Desk& desk, const Report& report) {
  List nodes;
  for (const auto& drive : report.drives) {
    Record node{{"axis", report::text_or_null(drive.axis)},
                {"bus", drive.bus},
                {"node", drive.node},
                {"family", drive.family}};
    List remarks;
    for (const auto id : kPartsOfDrive) {
      const auto part = std::find_if(drive.parts.begin(), drive.parts.end(),
                                     [&](const ReportPart& one) { return one.id == id; });
      const bool there = part != drive.parts.end();
      node.push_back({std::string(id), there ? part->value : Value()});
      for (const auto& remark : there ? part->remarks : std::vector<std::string>())
        remarks.emplace_back(remark);
    }
    List tests;
    for (const auto& test : drive.tests) tests.emplace_back(verdict_record(desk, test, Show::json));
    node.push_back({"tests", std::move(tests)});
    node.push_back({"remarks", std::move(remarks)});
    nodes.emplace_back(std::move(node));
  }
  List buses;
  for (const auto& bus : report.buses) {
    List remarks(bus.found.remarks.begin(), bus.found.remarks.end());
    buses.emplace_back(Record{
        {"bus", bus.url}, {"link", bus.link}, {"found", bus.found.value}, {"remarks", std::move(remarks)}});
  }
  Record out{{"servoctl_report", kReportVersion}, {"title", report.cover.title}};
  for (const auto& field : report.head) out.push_back(field);
  out.push_back({"buses", std::move(buses)});
  out.push_back({"nodes", std::move(nodes)});
  return report::to_json(std::move(out)) + "\n";
}

}  // namespace servoctl::trial
