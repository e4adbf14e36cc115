#include "cli/terminal/fitted.hpp"

#include <algorithm>

#include "base/lines.hpp"
#include "base/text.hpp"

namespace servoctl::cli {
namespace {

/// A first column is no wider.
constexpr std::size_t kWidestLead = 16;

/// Bytes of what stands before the text of a line: blanks, and a first column with two blanks behind it.
std::size_t lead_size(std::string_view line) {
  const auto begin = std::min(line.find_first_not_of(' '), line.size());
  const auto gap = line.find("  ", begin);
  if (gap == std::string_view::npos || gap > kWidestLead) return begin;
  return std::min(line.find_first_not_of(' ', gap), line.size());
}

std::string fitted_line(std::string_view line, std::size_t width) {
  if (display_width(line) <= width) return std::string(line);
  const auto lead = lead_size(line);
  const auto left = display_width(line.substr(0, lead));
  const bool has_column = line.substr(0, lead).find_first_not_of(' ') != std::string_view::npos;
  const auto indent = has_column ? left : left + 2;
  return std::string(line.substr(0, lead)) + wrapped(line.substr(lead), indent, width);
}

}  // namespace

std::string fitted(std::string_view text, std::size_t width) {
  if (width == 0) return std::string(text);
  return change_lines(text, [&](std::string_view line) { return fitted_line(line, width); });
}

}  // namespace servoctl::cli
