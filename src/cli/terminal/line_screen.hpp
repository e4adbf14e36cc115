#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cli/terminal/terminal_view.hpp"

namespace servoctl::cli {

/// What stands before a line that is typed.
struct PromptText {
  std::string text;
  bool alarm = false;  ///< In red where there are colours.
  bool operator==(const PromptText&) const = default;
};

/// The size, or a usual one for a terminal that does not say it.
Screen::Size usable_size(Screen::Size size);

/// A prompt, a line and what is told below it, as rows of a terminal: wide characters take two columns, and
/// one that does not fit goes to the next row. Knows what it has put on the screen, and replaces that.
class LineScreen {
 public:
  struct Picture {
    PromptText prompt;
    std::vector<std::string> characters;
    std::size_t cursor = 0;          ///< Before this character.
    std::vector<std::string> below;  ///< No wider than the terminal.
  };

  /// What to write so that the terminal shows the picture in the place of the one before. Of one that is
  /// higher than the terminal the part around the cursor.
  std::string show(const Picture& picture, Screen::Size size);
  /// What to write so that nothing of it is left and the cursor stands where it began.
  std::string wipe(Screen::Size size);
  /// What to write so that the line stays and the cursor stands below it.
  std::string leave(const Picture& picture, Screen::Size size);
  /// The next picture begins at a screen that is empty.
  void forget() { shown_.rows.clear(); }

 private:
  struct Row {
    std::string text;
    std::size_t width = 0;
    std::vector<std::uint8_t> characters;  ///< The columns that each takes.
    void put(std::string_view character);
  };
  struct Layout {
    std::vector<Row> rows;
    std::size_t cursor_row = 0;
    std::size_t cursor_column = 0;
    std::size_t cursor_character = 0;  ///< Of its row.
  };
  static Layout layout(const Picture& picture, std::size_t columns);

  Layout shown_;  ///< On the screen; no rows: nothing is.
};

}  // namespace servoctl::cli
