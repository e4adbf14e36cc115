#include "can/text_lines.hpp"

#include <algorithm>

#include "base/utf8.hpp"

namespace servoctl::can {
namespace {

constexpr std::size_t kLongestLine = std::size_t{64} << 10U;

/// Takes `> ` of quoted mails off, however often, but not the `>` of a remark in a line.
std::string_view without_quote_marks(std::string_view line) {
  for (;;) {
    const auto at = line.find_first_not_of(" \t");
    if (at == std::string_view::npos || line[at] != '>') return line;
    line.remove_prefix(at + 1);
  }
}

}  // namespace

void TextLines::read_mark() {
  begun_ = true;
  const auto begin = bytes_->ahead(3);
  wide_ = begin.starts_with("\xFF\xFE") || begin.starts_with("\xFE\xFF");
  big_ = begin.starts_with("\xFE\xFF");
  if (wide_)
    bytes_->drop(2);
  else if (begin.starts_with("\xEF\xBB\xBF"))
    bytes_->drop(3);
}

/// The bytes of the next line; `taken_` counts its line end as well.
bool TextLines::take_bytes(std::string_view& out, bool& ended) {
  const std::string_view end = !wide_ ? std::string_view("\n", 1)
                               : big_ ? std::string_view("\0\n", 2)
                                      : std::string_view("\n\0", 2);
  std::size_t searched = 0;
  for (;;) {
    const auto here = bytes_->here();
    auto at = here.find(end, searched);
    while (wide_ && at != std::string_view::npos && at % 2 != 0) at = here.find(end, at + 1);
    const bool too_long = at == std::string_view::npos ? here.size() >= kLongestLine : at > kLongestLine;
    ended = at != std::string_view::npos || too_long;
    if (ended || !bytes_->read_more()) {
      const auto rest = bytes_->here();
      out = rest.substr(0, too_long ? kLongestLine : std::min(at, rest.size()));
      taken_ = out.size() + (ended && !too_long ? end.size() : 0);
      return !rest.empty();
    }
    searched = here.size() - here.size() % 2;
    if (wide_ && searched > 0) searched -= 2;
  }
}

std::string_view TextLines::to_utf8(std::string_view wide) {
  text_.clear();
  for (std::size_t i = 0; i + 1 < wide.size(); i += 2) {
    const char32_t first = static_cast<unsigned char>(wide[i]);
    const char32_t second = static_cast<unsigned char>(wide[i + 1]);
    const char32_t unit = big_ ? first << 8U | second : second << 8U | first;
    // Nothing that is read of a line lies beyond the basic plane.
    append_utf8(unit >= 0xD800 && unit <= 0xDFFF ? U'?' : unit, text_);
  }
  return text_;
}

/// Without what does not belong to the recording but to where it was shown.
std::string_view TextLines::without_dress(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  line = without_quote_marks(line);
  if (line.find('\x1B') == std::string_view::npos) return line;
  bare_.clear();
  while (!line.empty()) {
    const auto escape = line.find("\x1B[");
    bare_ += line.substr(0, escape);
    if (escape == std::string_view::npos) break;
    line.remove_prefix(escape + 2);
    const auto last = line.find_first_not_of("0123456789;");
    line.remove_prefix(std::min(last == std::string_view::npos ? line.size() : last + 1, line.size()));
  }
  return bare_;
}

bool TextLines::take(TextLine& out) {
  bytes_->drop(taken_);
  taken_ = 0;
  if (!begun_) read_mark();
  std::string_view line;
  bool ended = false;
  if (!take_bytes(line, ended)) return false;
  out.offset = bytes_->offset();
  out.number = ++number_;
  out.ended = ended;
  out.text = without_dress(wide_ ? to_utf8(line) : line);
  return true;
}

}  // namespace servoctl::can
