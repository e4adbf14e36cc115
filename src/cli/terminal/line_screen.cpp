#include "cli/terminal/line_screen.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"

namespace servoctl::cli {
namespace {

constexpr std::string_view kRed = "\x1B[1;31m";
constexpr std::string_view kPlain = "\x1B[0m";
/// A terminal that does not say how large it is.
constexpr Screen::Size kUsual{80, 24};

/// Breaks between the first so many characters of a row where the terminal has become narrower.
std::size_t breaks(const std::vector<std::uint8_t>& characters, std::size_t count, std::size_t columns) {
  std::size_t out = 0;
  std::size_t column = 0;
  for (std::size_t i = 0; i < std::min(count, characters.size()); ++i) {
    if (column + characters[i] > columns) {
      ++out;
      column = 0;
    }
    column += characters[i];
  }
  return out;
}

}  // namespace

Screen::Size usable_size(Screen::Size size) {
  if (size.columns == 0 || size.rows == 0) return kUsual;
  return {std::max<std::size_t>(size.columns, 2), size.rows};
}

void LineScreen::Row::put(std::string_view character) {
  const auto columns = display_width(character);
  text += character;
  width += columns;
  characters.push_back(static_cast<std::uint8_t>(columns));
}

LineScreen::Layout LineScreen::layout(const Picture& picture, std::size_t columns) {
  Layout out;
  out.rows.emplace_back();
  const auto put = [&](std::string_view character) {
    if (out.rows.back().width + display_width(character) > columns) out.rows.emplace_back();
    out.rows.back().put(character);
  };
  const auto each = [](std::string_view text, const auto& take) {
    while (!text.empty()) {
      const auto size = decode_utf8(text).size;
      take(text.substr(0, size));
      text.remove_prefix(size);
    }
  };
  if (picture.prompt.alarm) out.rows.back().text += kRed;
  each(picture.prompt.text, put);
  if (picture.prompt.alarm) out.rows.back().text += kPlain;
  const auto mark = [&](std::string_view next) {
    const bool full = out.rows.back().width + std::max<std::size_t>(1, display_width(next)) > columns;
    if (full) out.rows.emplace_back();
    out.cursor_row = out.rows.size() - 1;
    out.cursor_column = out.rows.back().width;
    out.cursor_character = out.rows.back().characters.size();
  };
  for (std::size_t i = 0; i < picture.characters.size(); ++i) {
    if (i == picture.cursor) mark(picture.characters[i]);
    put(picture.characters[i]);
  }
  if (picture.cursor >= picture.characters.size()) mark({});
  for (const auto& line : picture.below) {
    out.rows.emplace_back();
    each(line, [&](std::string_view character) { out.rows.back().put(character); });
  }
  return out;
}

std::string LineScreen::wipe(Screen::Size size) {
  if (shown_.rows.empty()) return {};
  // A terminal that has become narrower has broken the rows anew, that of the cursor too.
  const auto columns = usable_size(size).columns;
  const auto& own = shown_.rows[shown_.cursor_row].characters;
  auto up = shown_.cursor_row + breaks(own, shown_.cursor_character + 1, columns);
  for (std::size_t i = 0; i < shown_.cursor_row; ++i) {
    const auto& row = shown_.rows[i].characters;
    up += breaks(row, row.size(), columns);
  }
  shown_.rows.clear();
  return (up == 0 ? std::string("\r") : formatted("\x1B[{}A\r", up)) + "\x1B[J";
}

std::string LineScreen::show(const Picture& picture, Screen::Size size) {
  const auto room = usable_size(size);
  auto now = layout(picture, room.columns);
  if (now.rows.size() > room.rows) {
    const auto last = std::clamp(now.cursor_row + 1, room.rows, now.rows.size());
    const auto first = last - room.rows;
    now.rows = {now.rows.begin() + static_cast<std::ptrdiff_t>(first),
                now.rows.begin() + static_cast<std::ptrdiff_t>(last)};
    now.cursor_row -= first;
  }
  auto out = wipe(size);
  for (std::size_t i = 0; i < now.rows.size(); ++i) out += (i == 0 ? "" : "\r\n") + now.rows[i].text;
  const auto below = now.rows.size() - 1 - now.cursor_row;
  if (below > 0 || now.cursor_column != now.rows.back().width) {
    if (below > 0) out += formatted("\x1B[{}A", below);
    out += "\r";
    if (now.cursor_column > 0) out += formatted("\x1B[{}C", now.cursor_column);
  }
  shown_ = std::move(now);
  return out;
}

std::string LineScreen::leave(const Picture& picture, Screen::Size size) {
  auto last = picture;
  last.below.clear();
  last.cursor = last.characters.size();
  auto out = show(last, size);
  // A row that is full has put the cursor on an empty one already.
  if (shown_.rows.back().width > 0) out += "\r\n";
  forget();
  return out;
}

}  // namespace servoctl::cli
