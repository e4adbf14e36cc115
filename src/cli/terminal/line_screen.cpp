#include "cli/terminal/line_screen.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/text.hpp"
#include "base/utf8.hpp"

namespace servoctl::cli {
namespace {

constexpr std::string_view kRed = "\x1B[1;31m";
constexpr std::string_view kPlain = "\x1B[0m";
/// A terminal that does not say how large it is.
constexpr Screen::Size kUsual{80, 24};

/// Rows that one of this width takes where the terminal has become narrower and broke it.
std::size_t height(std::size_t width, std::size_t columns) {
  return std::max<std::size_t>(1, (width + columns - 1) / columns);
}

}  // namespace

Screen::Size usable_size(Screen::Size size) {
  if (size.columns == 0 || size.rows == 0) return kUsual;
  return {std::max<std::size_t>(size.columns, 2), size.rows};
}

LineScreen::Layout LineScreen::layout(const Picture& picture, std::size_t columns) {
  Layout out;
  out.rows.emplace_back();
  const auto put = [&](std::string_view character) {
    const auto width = display_width(character);
    if (out.rows.back().width + width > columns) out.rows.emplace_back();
    out.rows.back().text += character;
    out.rows.back().width += width;
  };
  if (picture.prompt.alarm) out.rows.back().text += kRed;
  for (std::string_view rest = picture.prompt.text; !rest.empty();) {
    const auto size = decode_utf8(rest).size;
    put(rest.substr(0, size));
    rest.remove_prefix(size);
  }
  if (picture.prompt.alarm) out.rows.back().text += kPlain;
  const auto mark = [&](std::string_view next) {
    const bool full = out.rows.back().width + std::max<std::size_t>(1, display_width(next)) > columns;
    if (full) out.rows.emplace_back();
    out.cursor_row = out.rows.size() - 1;
    out.cursor_column = out.rows.back().width;
  };
  for (std::size_t i = 0; i < picture.characters.size(); ++i) {
    if (i == picture.cursor) mark(picture.characters[i]);
    put(picture.characters[i]);
  }
  if (picture.cursor >= picture.characters.size()) mark({});
  for (const auto& line : picture.below) out.rows.push_back({line, display_width(line)});
  return out;
}

std::string LineScreen::wipe(Screen::Size size) {
  if (rows_.empty()) return {};
  // A terminal that has become narrower has broken the rows anew.
  std::size_t up = 0;
  const auto columns = usable_size(size).columns;
  for (std::size_t i = 0; i < cursor_row_; ++i) up += height(rows_[i].width, columns);
  rows_.clear();
  return (up == 0 ? std::string("\r") : fmt::format("\x1B[{}A\r", up)) + "\x1B[J";
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
    if (below > 0) out += fmt::format("\x1B[{}A", below);
    out += "\r";
    if (now.cursor_column > 0) out += fmt::format("\x1B[{}C", now.cursor_column);
  }
  rows_ = std::move(now.rows);
  cursor_row_ = now.cursor_row;
  return out;
}

std::string LineScreen::leave(const Picture& picture, Screen::Size size) {
  auto last = picture;
  last.below.clear();
  last.cursor = last.characters.size();
  auto out = show(last, size);
  // A row that is full has put the cursor on an empty one already.
  if (rows_.back().width > 0) out += "\r\n";
  forget();
  return out;
}

}  // namespace servoctl::cli
