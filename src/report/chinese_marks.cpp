#include "report/chinese_marks.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace servoctl::report {
namespace {

constexpr std::string_view kOpen = "（";
constexpr std::string_view kClose = "）";

/// Quotes, and what ends them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kQuotes{
    {{"`", "`"}, {"'", "'"}, {"\"", "\""}, {"“", "”"}}};

std::string_view wide_mark(char mark) {
  switch (mark) {
    case ',': return "，";
    case ';': return "；";
    case ':': return "：";
    case '?': return "？";
    case '!': return "！";
    default: return {};
  }
}

/// A Chinese character, or one of the wide marks: `，`.
bool begins_chinese(std::string_view text) {
  return text.size() >= 3 && static_cast<unsigned char>(text.front()) >= 0xE3 &&
         static_cast<unsigned char>(text.front()) <= 0xEF;
}
bool ends_chinese(std::string_view text) {
  return text.size() >= 3 && begins_chinese(text.substr(text.size() - 3));
}
bool begins_character(std::string_view text) {
  return begins_chinese(text) && static_cast<unsigned char>(text.front()) <= 0xE9 &&
         !text.starts_with("\xE3\x80");
}
bool has_character(std::string_view text) {
  for (std::size_t at = 0; at < text.size(); ++at)
    if (begins_character(text.substr(at))) return true;
  return false;
}
bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         static_cast<unsigned char>(c) >= 0x80;
}

/// Bytes of the quote that begins here, with its marks; 0 where none does. The apostrophe of `drive's` is
/// none.
std::size_t quote_at(std::string_view text, std::size_t at) {
  for (const auto& [open, close] : kQuotes) {
    if (!text.substr(at).starts_with(open)) continue;
    if (open == "'" && at > 0 && is_word(text[at - 1]) && !ends_chinese(text.substr(0, at))) continue;
    const auto end = text.find(close, at + open.size());
    if (end != std::string_view::npos) return end + close.size() - at;
  }
  return 0;
}

/// `a.txt:3`: a line of a file, of which the rest of a message is told.
bool ends_with_line(std::string_view text) {
  const auto last = text.find_last_not_of("0123456789");
  return last != std::string_view::npos && last + 1 < text.size() && last > 0 && text[last] == ':' &&
         is_word(text[last - 1]) && text.rfind(' ', last) == std::string_view::npos;
}

/// One pass through a text.
class Marks {
 public:
  explicit Marks(std::string_view text) : text_(text) {}

  std::string all() {
    for (std::size_t at = 0; at < text_.size();) at += take(at);
    return std::move(out_);
  }

 private:
  struct Bracket {
    std::size_t at = 0;  ///< In out_.
    bool wide = false;
  };

  /// Takes what begins here; how many bytes that was.
  std::size_t take(std::size_t at) {
    if (const auto quote = quote_at(text_, at); quote > 0) return keep(at, quote);
    const auto rest = text_.substr(at);
    if (rest.starts_with(kOpen)) {
      opened_.push_back({out_.size(), true});
      return keep(at, kOpen.size());
    }
    if (rest.front() == '(') {
      opened_.push_back({out_.size(), false});
      return keep(at, 1);
    }
    if (rest.front() == ')' || rest.starts_with(kClose))
      return closed(at, rest.front() == ')' ? 1 : kClose.size());
    if (const auto wide = wide_mark(rest.front()); !wide.empty() && stands_beside_chinese(rest)) {
      out_ += wide;
      return rest.size() > 1 && rest[1] == ' ' ? 2 : 1;
    }
    if (const auto joint = joint_of_characters(rest); !joint.empty()) {
      out_ += joint;
      return joint.size() + 2;
    }
    return keep(at, 1);
  }

  /// `电机 或 监视` is written `电机或监视`: what joins names stands between blanks beside Latin ones alone.
  std::string_view joint_of_characters(std::string_view rest) const {
    if (rest.front() != ' ' || !ends_chinese(out_)) return {};
    for (const std::string_view word : {"或", "和"})
      if (rest.substr(1).starts_with(word) && rest.substr(1 + word.size()).starts_with(' ') &&
          begins_character(rest.substr(2 + word.size())))
        return rest.substr(1, word.size());
    return {};
  }

  std::size_t keep(std::size_t at, std::size_t size) {
    out_ += text_.substr(at, size);
    return size;
  }

  /// `a:b` is one name.
  bool stands_beside_chinese(std::string_view rest) const {
    const auto behind = rest.substr(1);
    const bool ends =
        behind.empty() || behind.front() == ' ' || behind.front() == '\n' || begins_chinese(behind);
    if (!ends) return false;
    const bool blank = behind.starts_with(' ');
    // `gsd600? 或 ts?` are guesses.
    const bool asks = rest.front() == '?' || rest.front() == '!';
    if (asks) return ends_chinese(out_);
    if (rest.front() == ':' && blank && ends_with_line(out_)) return true;
    return ends_chinese(out_) || begins_character(blank ? behind.substr(1) : behind);
  }

  std::size_t closed(std::size_t at, std::size_t size) {
    if (opened_.empty()) return keep(at, size);
    const auto bracket = opened_.back();
    opened_.pop_back();
    const auto before = std::string_view(out_).substr(0, bracket.at);
    const bool blank = before.ends_with(' ') && !before.ends_with("  ");
    const auto word = blank ? before.substr(0, before.size() - 1) : before;
    const auto inside = std::string_view(out_).substr(bracket.at + (bracket.wide ? kOpen.size() : 1));
    const bool wide = bracket.wide || size == kClose.size() || ends_chinese(word) || has_character(inside) ||
                      begins_character(text_.substr(at + size));
    if (!wide) return keep(at, size);
    const auto content = std::string(inside);
    out_.resize(word.empty() ? before.size() : word.size());
    ((out_ += kOpen) += content) += kClose;
    return size;
  }

  std::string_view text_;
  std::string out_;
  std::vector<Bracket> opened_;
};

}  // namespace

std::string chinese_marks(std::string_view text) {
  return has_character(text) ? Marks(text).all() : std::string(text);
}

}  // namespace servoctl::report
