#pragma once

#include <vector>

#include "command/context.hpp"
#include "trial/drive_report.hpp"
#include "trial/earlier_tests.hpp"

namespace servoctl::command {

/// Asks the nodes of the context and of the other ones beside it (Context::others), tests their
/// communication, and adds the results of earlier tests of theirs: what stands in a report. Axes come in the
/// order of the cabinet file. Parts that a drive refuses carry the reason; a node without answer is one of
/// the errors of its context, and so is a test that failed; a test of a node that is not asked is a notice.
/// Errc::bus or interrupted when it could not be done, timeout when no node answers, refused where an earlier
/// test was made of another drive.
Result<trial::Report> collect_report(Context& context, trial::ReportCover cover,
                                     std::vector<trial::EarlierTest> earlier);

}  // namespace servoctl::command
