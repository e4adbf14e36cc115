#include "trial/report_head.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/calendar.hpp"
#include "base/format.hpp"
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
  if (tests.failed == 0) return say(desk, formatted("{} passed", passed));
  return say(desk, formatted("{} passed, {} FAILED", passed, tests.failed));
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

std::string family_text(const show::Desk& desk) {
  const auto& rules = desk.profile->rules;
  return formatted("{} ({} {})", desk.profile->family, rules.vendor,
                   desk.chinese && !rules.name_zh.empty() ? rules.name_zh : rules.name);
}

/// What the desks have of it, each once.
std::string of_all(std::span<const show::Desk* const> desks, std::string (*text)(const show::Desk&)) {
  std::vector<std::string> out;
  for (const auto* desk : desks)
    if (const auto one = text(*desk); std::find(out.begin(), out.end(), one) == out.end()) out.push_back(one);
  return formatted("{}", fmt::join(out, ", "));
}

std::string url_of(const show::Desk& desk) { return desk.session->url(); }

}  // namespace

Record report_head(std::span<const show::Desk* const> desks, const ReportCover& cover,
                   const TestCount& tests) {
  const auto& desk = *desks.front();
  const auto all = Show::everywhere;
  report::List signatures;
  for (const auto& who : cover.signatures) signatures.emplace_back(who);
  Value logo;
  if (!cover.logo.type.empty()) logo = Record{{"type", cover.logo.type}, {"base64", cover.logo.base64}};
  return {{"customer", report::text_or_null(cover.customer), all, say(desk, "customer")},
          {"machine", report::text_or_null(cover.machine), all, say(desk, "machine")},
          {"operator", report::text_or_null(cover.operator_name), all, say(desk, "operator")},
          {"logo", std::move(logo), Show::json},
          {"signatures", cover.signatures.empty() ? Value() : Value(std::move(signatures)), Show::json},
          {"time", utc_now_text(), all, say(desk, "made at")},
          {"tool", formatted("servoctl {}", version()), all, say(desk, "made with")},
          {"bus_text", of_all(desks, url_of), Show::text, say(desk, "bus")},
          {"family_text", of_all(desks, family_text), Show::text, say(desk, "drive family")},
          {"tests_text", count_text(desk, tests), Show::text, say(desk, "tests")},
          {"tests_passed", tests.failed == 0, Show::json}};
}

Value link_record(const show::Desk& desk) {
  const auto link = session::link_of(desk.session->url());
  if (!link) return {};
  const auto or_null = [](const auto& value) { return value ? Value(*value) : Value(); };
  const auto all = Show::everywhere;
  return Record{{"bitrate", or_null(link->bitrate), all, say(desk, "bitrate (bit/s)")},
                {"controller", link->health ? Value(can::name(*link->health)) : Value(), all,
                 say(desk, "CAN controller")},
                {"tx_errors", or_null(link->tx_errors), all, say(desk, "send errors")},
                {"rx_errors", or_null(link->rx_errors), all, say(desk, "receive errors")}};
}

report::Table drive_table(const show::Desk& desk, const Report& report) {
  report::Table table;
  const bool families = report.is_of_several(&DriveReport::family);
  const bool buses = report.is_of_several(&DriveReport::bus);
  table.columns = {{"drive", say(desk, "drive")},
                   {"family", say(desk, "family"), families ? Show::text : Show::json},
                   {"bus", say(desk, "bus"), buses ? Show::text : Show::json},
                   {"device_name", say(desk, "device name")},
                   {"software_version", say(desk, "software")},
                   {"serial", say(desk, "serial")},
                   {"state", say(desk, "state")},
                   {"tests", say(desk, "tests")}};
  for (const auto& drive : report.drives) {
    const auto failed = std::count_if(drive.tests.begin(), drive.tests.end(),
                                      [](const auto& test) { return !report::passed(test); });
    const TestCount tests{drive.tests.size(), static_cast<std::size_t>(failed)};
    table.rows.push_back({drive.title, drive.family, drive.bus_name,
                          field_of(drive, "identity", "device_name"),
                          field_of(drive, "identity", "software_version"),
                          field_of(drive, "identity", "serial"), field_of(drive, "faults", "state"),
                          tests.all == 0 ? say(desk, "not asked") : count_text(desk, tests)});
  }
  return table;
}

}  // namespace servoctl::trial
