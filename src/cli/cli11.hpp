#pragma once

// CLI11, without what makes a one-shot line slow. Its `trim_copy` asks `std::locale()` of each character of
// each option's name, which makes the classic locale with all its facets ready: a third of what a line costs
// over a program in C. The names are ours and have ASCII blanks at most, so these two overloads, which are
// better matches for what `split_names` hands over, take its place. Seen by one translation unit only:
// src/cli/parse.cpp.

#include <CLI/StringTools.hpp>
#include <string>

#include "base/text.hpp"

namespace CLI::detail {

inline std::string trim_copy(std::string&& name) { return std::string(servoctl::trim(name)); }

inline std::string trim_copy(std::string& name) { return std::string(servoctl::trim(name)); }

}  // namespace CLI::detail

#include <CLI/CLI.hpp>
