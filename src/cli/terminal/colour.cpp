#include "cli/terminal/colour.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "base/lines.hpp"
#include "base/text.hpp"

namespace servoctl::cli {
namespace {

constexpr std::string_view kRed = "\x1B[31m";
constexpr std::string_view kYellow = "\x1B[33m";
constexpr std::string_view kGreen = "\x1B[32m";
constexpr std::string_view kFarIn = "      ";
constexpr std::string_view kPlain = "\x1B[0m";

struct Word {
  std::string_view text;
  std::string_view colour;
};

/// How a line begins.
constexpr std::array kStarts{Word{"error: ", kRed}, Word{"错误：", kRed}, Word{"warning: ", kYellow},
                             Word{"警告：", kYellow}};

/// What a cell says as a whole.
constexpr std::array kCells{
    Word{"fault", kRed},
    Word{"FAILED", kRed},
    Word{"failed", kRed},
    Word{"refused", kRed},
    Word{"in fault, no code in 603Fh: `fault show`", kRed},
    Word{"故障", kRed},
    Word{"处于故障状态，603Fh 无代码：`fault show`", kRed},
    Word{"失败", kRed},
    Word{"未通过", kRed},
    Word{"caution", kYellow},
    Word{"CAUTION", kYellow},
    Word{"注意", kYellow},
    Word{"警告", kYellow},
    Word{"ok", kGreen},
    Word{"passed", kGreen},
    Word{"正常", kGreen},
    Word{"通过", kGreen},
};

std::string painted(std::string_view text, std::string_view colour) {
  return std::string(colour).append(text).append(kPlain);
}

/// A cell, without the blanks around it.
std::string cell(std::string_view text) {
  const auto* word =
      std::find_if(kCells.begin(), kCells.end(), [&](const Word& one) { return one.text == text; });
  return word == kCells.end() ? std::string(text) : painted(text, word->colour);
}

/// What a line may begin with; in every other place the first cell is the name of what follows.
bool is_verdict(std::string_view cell) {
  constexpr std::array<std::string_view, 5> kVerdicts{"ok", "caution", "FAILED", "正常", "注意"};
  return std::find(kVerdicts.begin(), kVerdicts.end(), cell) != kVerdicts.end();
}

/// Column heads are words as well, and say nothing of any drive.
std::string line(std::string_view text, bool heads) {
  const auto* start = std::find_if(kStarts.begin(), kStarts.end(),
                                   [&](const Word& one) { return text.starts_with(one.text); });
  if (start != kStarts.end())
    return painted(start->text, start->colour).append(text.substr(start->text.size()));
  // What a cell goes on with below its first line is part of a sentence.
  if (text.starts_with(kFarIn)) return std::string(text);
  std::string out;
  for (bool first = true; !text.empty(); first = false) {
    const auto begin = std::min(text.find_first_not_of(' '), text.size());
    out += text.substr(0, begin);
    text.remove_prefix(begin);
    const auto end = std::min(text.find("  "), text.size());
    const auto word = text.substr(0, end);
    out += (first ? is_verdict(word) : !heads) ? cell(word) : std::string(word);
    text.remove_prefix(end);
  }
  return out;
}

}  // namespace

Colour parse_colour(std::string_view word) {
  return word == "always" ? Colour::always : word == "never" ? Colour::never : Colour::automatic;
}

bool has_colours(Colour wanted, int descriptor) {
  if (wanted != Colour::automatic) return wanted == Colour::always;
  const char* none = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  const bool has_some = terminal != nullptr && *terminal != '\0' && std::string_view(terminal) != "dumb";
  return has_some && (none == nullptr || *none == '\0') && ::isatty(descriptor) == 1;
}

std::string coloured(std::string_view text) {
  bool heads = true;
  return change_lines(text, [&](std::string_view one) {
    auto out = line(one, heads);
    heads = one.empty() || one.ends_with(':') || one.ends_with("：");
    return out;
  });
}

}  // namespace servoctl::cli
