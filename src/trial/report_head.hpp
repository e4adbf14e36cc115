#pragma once

#include <cstddef>
#include <span>

#include "report/value.hpp"
#include "show/desk.hpp"
#include "trial/drive_report.hpp"

namespace servoctl::trial {

/// How the tests of a report ended.
struct TestCount {
  std::size_t all = 0;
  std::size_t failed = 0;
};

/// For whom, by whom, when, with what, where, and how the tests ended: the first lines of a report. A desk
/// for each bus and family.
report::Record report_head(std::span<const show::Desk* const> desks, const ReportCover& cover,
                           const TestCount& tests);

/// What the kernel knows of the desk's interface; null for other buses.
report::Value link_record(const show::Desk& desk);

/// One line for each drive: name, what it is, firmware, serial number, state and tests, where there are
/// several also family and bus. For people.
report::Table drive_table(const show::Desk& desk, const Report& report);

}  // namespace servoctl::trial
