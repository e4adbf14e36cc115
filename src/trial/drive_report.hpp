#pragma once

#include <string>
#include <vector>

#include "report/html.hpp"
#include "report/verdict.hpp"
#include "show/desk.hpp"
#include "trial/report_cover.hpp"

/// What is written down of drives when they are handed over.
namespace servoctl::trial {

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
  ReportCover cover;    ///< With the title.
  report::Record head;  ///< As report_head() makes it.
  ReportPart bus;       ///< Who is there.
  report::Value link;   ///< What the kernel knows of the interface; null for other buses.
  std::vector<DriveReport> drives;
};

/// As a page, in the language of the desk.
std::string report_page(const show::Desk& desk, const Report& report);
/// As one JSON document.
std::string report_json(const show::Desk& desk, const Report& report);

}  // namespace servoctl::trial
