#include "cli/terminal/ascii_form.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>

#include "base/format.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"

namespace servoctl::cli {
namespace {

struct Form {
  char32_t sign;
  std::string_view ascii;
};

constexpr std::array kForms{
    Form{U'…', "..."},   Form{U'·', "."},   Form{U'→', "->"},    Form{U'←', "<-"},  Form{U'↔', "<->"},
    Form{U'°', "deg"},   Form{U'µ', "u"},   Form{U'μ', "u"},     Form{U'²', "2"},   Form{U'³', "3"},
    Form{U'×', "x"},     Form{U'≤', "<="},  Form{U'≥', ">="},    Form{U'≠', "!="},  Form{U'±', "+/-"},
    Form{U'–', "-"},     Form{U'—', "-"},   Form{U'−', "-"},     Form{U'“', "\""},  Form{U'”', "\""},
    Form{U'‘', "'"},     Form{U'’', "'"},   Form{U'┤', "|"},     Form{U'├', "|"},   Form{U'│', "|"},
    Form{U'┃', "|"},     Form{U'─', "-"},   Form{U'━', "-"},     Form{U'└', "+"},   Form{U'┘', "+"},
    Form{U'┌', "+"},     Form{U'┐', "+"},   Form{U'┴', "+"},     Form{U'┬', "+"},   Form{U'┼', "+"},
    Form{U'√', "sqrt "}, Form{U'Ω', "Ohm"}, Form{U'↑', "^"},     Form{U'↓', "v"},   Form{U'▲', "^"},
    Form{U'▼', "v"},     Form{U'•', "*"},   Form{U'≈', "~"},     Form{U'✓', "yes"}, Form{U'π', "pi"},
    Form{U'½', "1/2"},   Form{U'¼', "1/4"}, Form{U'σ', "sigma"}, Form{U'ß', "ss"},  Form{U'ä', "ae"},
    Form{U'ö', "oe"},    Form{U'ü', "ue"},  Form{U'Ä', "Ae"},    Form{U'Ö', "Oe"},  Form{U'Ü', "Ue"},
};

/// Dots of a plot in braille: the more of them, the darker.
char dots(char32_t c) {
  constexpr std::string_view kShades = " .:::****";
  return kShades[static_cast<std::size_t>(std::popcount(static_cast<std::uint32_t>(c - U'\u2800')))];
}

/// A bar of a small plot, an eighth to eight eighths high.
char bar(char32_t c) {
  constexpr std::string_view kHeights = "_.-=+*%#";
  return kHeights[c - U'\u2581'];
}

std::string form_of(char32_t c) {
  if (c < 0x80) return {static_cast<char>(c)};
  if (c >= U'\u2800' && c <= U'\u28FF') return {dots(c)};
  if (c >= U'\u2581' && c <= U'\u2588') return {bar(c)};
  const auto* form =
      std::find_if(kForms.begin(), kForms.end(), [&](const Form& one) { return one.sign == c; });
  if (form != kForms.end()) return std::string(form->ascii);
  return c > 0xFFFF ? formatted("\\U{:08X}", static_cast<std::uint32_t>(c))
                    : formatted("\\u{:04X}", static_cast<std::uint32_t>(c));
}

}  // namespace

bool locale_is_not_utf8() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    const auto locale = lower(value);
    return locale.find("utf-8") == std::string::npos && locale.find("utf8") == std::string::npos;
  }
  return false;
}

std::string ascii_form(std::string_view text) {
  std::string out;
  std::size_t too_wide = 0;
  std::size_t blanks = 0;
  while (!text.empty()) {
    const auto c = decode_utf8(text);
    const auto shown =
        c.value ? form_of(*c.value) : formatted("\\x{:02X}", static_cast<std::uint8_t>(text[0]));
    if (text[0] == '\n') too_wide = 0;
    const auto width = c.value ? columns(*c.value) : 1;
    if (shown.size() > width && text[0] != '\n' && text[0] != '\t') too_wide += shown.size() - width;
    blanks = text[0] == ' ' ? blanks + 1 : 0;
    text.remove_prefix(c.size);
    // Two blanks stay between columns.
    if (blanks > 2 && too_wide > 0)
      --too_wide;
    else
      out += shown;
  }
  return out;
}

std::string ascii_clip(std::string_view text, std::size_t columns) {
  constexpr std::string_view kCut = "...";
  if (text.size() <= columns) return std::string(text);
  return std::string(text.substr(0, columns - std::min(columns, kCut.size()))) +
         std::string(kCut.substr(0, columns));
}

}  // namespace servoctl::cli
