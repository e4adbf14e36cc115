#include "trial/drive_report.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "report/catalogue.hpp"
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
  return fmt::format("{} ({})", report::in_chinese(test + " test"), test);
}

/// Name and verdict are the heading.
report::Page::Section test_section(const show::Desk& desk, const TestResult& test) {
  auto record = verdict_record(desk, test, Show::everywhere);
  std::erase_if(record, [](const report::Field& field) {
    return field.key == "test" || field.key == "node" || field.key == "verdict";
  });
  const Value origin(test.origin);
  if (const auto* time = report::find(origin, "time"))
    record.insert(record.begin(), {"time", *time, Show::text, say(desk, "made at", "测试时间")});
  return {fmt::format("{}: {}", test_name(desk, test.test),
                      passed(test) ? say(desk, "passed", "通过") : say(desk, "FAILED", "未通过")),
          4, told(desk, std::move(record))};
}

}  // namespace

std::string report_page(const show::Desk& desk, const Report& report) {
  const auto& cover = report.cover;
  const Value head(report.head);
  const auto time = std::get<std::string>(report::find(head, "time")->data());
  report::Page page{.chinese = desk.chinese, .title = cover.title};
  if (desk.chinese) page.translate = [](std::string_view heading) { return report::in_chinese(heading); };
  page.picture = cover.logo.uri();
  page.signatures = cover.signatures;
  constexpr std::size_t kFootName = 36;  // Columns: both and the time fit into one line.
  page.foot = joined({clip(cover.customer, kFootName), clip(cover.machine, kFootName), time}, ", ");
  page.sections.push_back({say(desk, "Summary", "概要"), 2, told(desk, report.head)});
  page.sections.push_back({say(desk, "Drives", "驱动器"), 2, told(desk, drive_table(desk, report))});
  page.sections.push_back({report.bus.title, 2, told(desk, List{report.link, report.bus.value}),
                           joined_remarks(desk, report.bus.remarks)});
  for (const auto& drive : report.drives) {
    page.sections.push_back({drive.title, 2, {}, joined({cover.machine, time}, ", "), true});
    for (const auto& part : drive.parts)
      page.sections.push_back({part.title, 3, told(desk, part.value), joined_remarks(desk, part.remarks)});
    if (!drive.tests.empty()) page.sections.push_back({say(desk, "Tests", "测试"), 3});
    for (const auto& test : drive.tests) page.sections.push_back(test_section(desk, test));
  }
  return report::html_page(page);
}

std::string report_json(const show::Desk& desk, const Report& report) {
  List nodes;
  for (const auto& drive : report.drives) {
    Record node{{"node", drive.node}};
    List remarks;
    for (const auto& part : drive.parts) {
      node.push_back({part.id, part.value});
      for (const auto& remark : part.remarks) remarks.emplace_back(remark);
    }
    List tests;
    for (const auto& test : drive.tests) tests.emplace_back(verdict_record(desk, test, Show::json));
    node.push_back({"tests", std::move(tests)});
    node.push_back({"remarks", std::move(remarks)});
    nodes.emplace_back(std::move(node));
  }
  Record out{{"servoctl_report", 1}, {"title", report.cover.title}};
  for (const auto& field : report.head) out.push_back(field);
  out.push_back({"link", report.link});
  out.push_back({"found", report.bus.value});
  out.push_back({"nodes", std::move(nodes)});
  return report::to_json(std::move(out)) + "\n";
}

}  // namespace servoctl::trial
