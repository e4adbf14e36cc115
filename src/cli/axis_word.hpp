#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cabinet/cabinet.hpp"
#include "cli/parse.hpp"

namespace servoctl::cli {

/// The error of a line, which says more where a word too many may be meant as an axis: why the cabinet file
/// cannot be used, which axes it has, or that there is none.
Error about_axis(Error error, const std::vector<std::string>& words, const CommandMatch& match,
                 const std::function<Result<const cabinet::Cabinet*>()>& cabinet);

}  // namespace servoctl::cli
