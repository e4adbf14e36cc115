#pragma once

#include <string>
#include <vector>

#include "report/verdict.hpp"
#include "show/desk.hpp"

/// What tests measure beside their criteria, as it is shown: of a test that has just ended, and of one that a
/// file tells of.
namespace servoctl::trial {

/// `reads min median p95 max`: times from request to answer in ms; null where nothing was answered.
report::Field round_trip_figure(const show::Desk& desk, report::Value times);

/// A row for each homing: `run seconds position encoder`, the last two in `unit`, null where not known.
report::Field homings_figure(const show::Desk& desk, std::vector<report::List> rows, const std::string& unit);

/// Each change of an input; null where each was a record of its own.
report::Field events_figure(report::Value events);

/// Those of a record that a test wrote as JSON, by the kind of the test; nothing where it has none.
report::Record figures_of(const show::Desk& desk, const report::TestResult& test,
                          const report::Value& written);

}  // namespace servoctl::trial
