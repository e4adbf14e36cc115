#include "trial/report_head.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/calendar.hpp"
#include "base/version.hpp"
#include "session/open_bus.hpp"
#include "trial/verdict.hpp"

namespace servoctl::trial {
namespace {

using report::Record;
using report::Show;
using report::Value;

std::string count_text(const show::Desk& desk, const TestCount& tests) {
  const auto passed = tests.all - tests.failed;
  if (tests.failed == 0) return say(desk, fmt::format("{} passed", passed), fmt::format("{} 项通过", passed));
  return say(desk, fmt::format("{} passed, {} FAILED", passed, tests.failed),
             fmt::format("{} 项通过，{} 项未通过", passed, tests.failed));
}

/// What a part of it says for people; null where it says nothing.
Value field_of(const DriveReport& drive, std::string_view part, std::string_view key) {
  for (const auto& one : drive.parts) {
    const auto* record = std::get_if<Record>(&one.value.data());
    if (one.id != part || record == nullptr) continue;
    for (const auto& field : *record)
      if (field.key == key && field.show != Show::json) return field.value;
  }
  return {};
}

}  // namespace

Record report_head(const show::Desk& desk, const ReportCover& cover, const TestCount& tests) {
  const auto& rules = desk.profile->rules;
  const auto& name = desk.chinese && !rules.name_zh.empty() ? rules.name_zh : rules.name;
  const auto all = Show::everywhere;
  report::List signatures;
  for (const auto& who : cover.signatures) signatures.emplace_back(who);
  Value logo;
  if (!cover.logo.type.empty()) logo = Record{{"type", cover.logo.type}, {"base64", cover.logo.base64}};
  return {{"customer", report::text_or_null(cover.customer), all, say(desk, "customer", "客户")},
          {"machine", report::text_or_null(cover.machine), all, say(desk, "machine", "设备")},
          {"operator", report::text_or_null(cover.operator_name), all, say(desk, "operator", "操作人员")},
          {"logo", std::move(logo), Show::json},
          {"signatures", cover.signatures.empty() ? Value() : Value(std::move(signatures)), Show::json},
          {"time", utc_now_text(), all, say(desk, "made at", "生成时间")},
          {"tool", fmt::format("servoctl {}", version()), all, say(desk, "made with", "生成工具")},
          {"bus", desk.session->url(), all, say(desk, "bus", "总线")},
          {"family", fmt::format("{} ({} {})", desk.profile->family, rules.vendor, name), Show::text,
           say(desk, "drive family", "驱动器系列")},
          {"family", desk.profile->family, Show::json},
          {"tests_text", count_text(desk, tests), Show::text, say(desk, "tests", "测试")},
          {"tests_passed", tests.failed == 0, Show::json}};
}

Value link_record(const show::Desk& desk) {
  const auto link = session::link_of(desk.session->url());
  if (!link) return {};
  const auto or_null = [](const auto& value) { return value ? Value(*value) : Value(); };
  const auto all = Show::everywhere;
  return Record{{"bitrate", or_null(link->bitrate), all, say(desk, "bitrate (bit/s)", "波特率 (bit/s)")},
                {"controller", link->health ? Value(can::name(*link->health)) : Value(), all,
                 say(desk, "controller", "CAN 控制器")},
                {"tx_errors", or_null(link->tx_errors), all, say(desk, "send errors", "发送错误计数")},
                {"rx_errors", or_null(link->rx_errors), all, say(desk, "receive errors", "接收错误计数")}};
}

report::Table drive_table(const show::Desk& desk, const Report& report) {
  report::Table table;
  table.columns = {{"drive", say(desk, "drive", "驱动器")},
                   {"device_name", say(desk, "device name", "设备名称")},
                   {"software_version", say(desk, "software", "软件版本")},
                   {"serial", say(desk, "serial", "序列号")},
                   {"state", say(desk, "state", "状态")},
                   {"tests", say(desk, "tests", "测试")}};
  for (const auto& drive : report.drives) {
    const auto failed = std::count_if(drive.tests.begin(), drive.tests.end(),
                                      [](const auto& test) { return !report::passed(test); });
    const TestCount tests{drive.tests.size(), static_cast<std::size_t>(failed)};
    table.rows.push_back({drive.title, field_of(drive, "identity", "device_name"),
                          field_of(drive, "identity", "software_version"),
                          field_of(drive, "identity", "serial"), field_of(drive, "faults", "state"),
                          tests.all == 0 ? say(desk, "not asked", "未询问") : count_text(desk, tests)});
  }
  return table;
}

}  // namespace servoctl::trial
