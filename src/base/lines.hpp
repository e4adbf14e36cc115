#pragma once

#include <string>
#include <string_view>

namespace servoctl {

/// Each line of `text` as `change` makes it, in their order; the line ends stay as they are.
template <class Change>
std::string change_lines(std::string_view text, Change change) {
  std::string out;
  while (!text.empty()) {
    const auto end = text.find('\n');
    out += change(text.substr(0, end));
    if (end == std::string_view::npos) break;
    out += '\n';
    text.remove_prefix(end + 1);
  }
  return out;
}

}  // namespace servoctl
