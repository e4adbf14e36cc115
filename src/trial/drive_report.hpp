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
  std::string axis;      ///< Its name in the cabinet file; empty where it has none.
  std::string bus;       ///< URL.
  std::string bus_name;  ///< In the cabinet file; else the URL.
  std::string family;    ///< As `-d` takes it.
  std::string title;     ///< `feeder (node 1)`
  std::vector<ReportPart> parts = {};
  std::vector<report::TestResult> tests = {};  ///< The test of the communication, then earlier ones.
};

/// What is told of one bus.
struct BusReport {
  std::string url;
  std::string name;    ///< In the cabinet file; else the URL.
  report::Value link;  ///< What the kernel knows of the interface; null for other buses.
  ReportPart found;    ///< Who is there.
};

struct Report {
  ReportCover cover;    ///< With the title.
  report::Record head;  ///< As report_head() makes it.
  std::vector<BusReport> buses;
  std::vector<DriveReport> drives;

  /// Whether the drives are of several buses, or families: each page says its own then.
  bool is_of_several(std::string DriveReport::*what) const;
};

/// The parts of a drive in JSON, whether it answered or not.
inline constexpr std::string_view kPartsOfDrive[] = {"identity", "state", "faults",
                                                     "settings", "pdos",  "cabinet"};

/// As a page, in the language of the desk.
std::string report_page(const show::Desk& desk, const Report& report);
/// As one JSON document.
std::string report_json(const show::Desk& desk, const Report& report);

}  // namespace servoctl::trial
