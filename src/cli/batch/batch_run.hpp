#pragma once

#include <span>
#include <string>

#include "cli/batch/batch_plan.hpp"
#include "cli/shell.hpp"

namespace servoctl::cli {

/// Runs the steps of a batch file one after the other on the shell's bus and shows what comes of them: as at
/// the prompt in text, one document with `--json`, one a line with `-o jsonl`. `file` stands in messages. The
/// answer is the exit code of the first step that failed.
int run_steps(Shell& shell, std::span<const Step> steps, const std::string& file);

/// `error` as one of this line of the file: `setup.txt:12: …`.
Error at_line(const std::string& file, std::uint32_t line, Error error);

}  // namespace servoctl::cli
