#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "show/explanation.hpp"

/// Answers of `explain`, laid out for people. Each gives lines of at most `width` columns; pictures stand as
/// they are.
namespace servoctl::show {

/// One answer in full.
std::vector<std::string> topic_page(const Explanation& explanation, bool chinese, std::size_t width);

/// Topics by kind, a line each: name, the family if it is asked for, and title.
std::vector<std::string> topic_list(std::span<const Explanation> explanations, bool chinese,
                                    std::size_t width, bool with_families = false);

/// The names alone, those of a kind behind each other.
std::vector<std::string> topic_names(std::span<const Explanation> explanations, bool chinese,
                                     std::size_t width);

}  // namespace servoctl::show
