#pragma once

#include <string>
#include <vector>

#include "commands/command.hpp"
#include "report/html.hpp"
#include "report/verdict.hpp"

/// What is written down of drives when they are handed over.
namespace servoctl::commands {

/// One part of a report: what one command answers.
struct ReportPart {
  std::string id;     ///< `identity`: for programs.
  std::string title;  ///< `Identity`
  report::Value value;
  std::vector<std::string> remarks;  ///< What went wrong, or is worth knowing.
};

/// All that is told of one drive.
struct DriveReport {
  std::uint8_t node = 0;
  std::string title;  ///< `Node 1: GSD600`
  std::vector<ReportPart> parts;
  std::vector<report::TestResult> tests;  ///< The test of the communication, then earlier ones.
};

struct Report {
  std::string title;
  report::Record head;  ///< When, with what, where, and how the tests ended.
  ReportPart bus;       ///< Who is there.
  report::Value link;   ///< What the kernel knows of the interface; null for other buses.
  std::vector<DriveReport> drives;
};

/// Asks the nodes of the context, tests their communication, and adds the results of earlier tests of theirs.
/// Parts that a drive refuses carry the reason; a node without answer is one of the errors of the context,
/// and so is a test that failed. Errc::bus or interrupted when it could not be done, timeout when no node
/// answers.
Result<Report> make_report(Context& context, std::string title,
                           const std::vector<report::TestResult>& earlier);

/// As a page, in the language of the context.
std::string report_page(const Context& context, const Report& report);
/// As one JSON document.
std::string report_json(const Context& context, const Report& report);

}  // namespace servoctl::commands
