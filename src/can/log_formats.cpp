#include "can/log_formats.hpp"

#include <algorithm>

#include "base/number.hpp"
#include "base/text.hpp"
#include "can/log_columns.hpp"

namespace servoctl::can {
namespace {

constexpr LogNumbers kHex{16, 16, TimeUnit::open, false, false};
constexpr LogFormat kLogFormats[] = {
    {"python-can", "=Timestamp: time =ID: id word* =DL: len data", kHex},
    {"CANreal", "number any? clock fraction any? dec id word? len data", {}},
    {"CanKing", "chan id word? len data time dir", {}},
    {"CanKing", "chan any =ErrorFrame time dir", {}},
    {"BUSMASTER", "clock dir chan id word len data", {}},
    {"CANoe", "time =CAN? chan id dir =d|r len? data", {}},
    {"CANoe", "time =CAN? chan =ErrorFrame", {}},
    // A number in front is one of the line only where what follows could not be its frame.
    {"plain", "number time chan? dir? id dir? word* len? data", {}},
    {"plain", "number chan? dir? id dir? word* len data", {}},
    {"plain", "time? chan? dir? id dir? word* len? data", {}},
};

bool all_digits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// `0`, `can0`, `CH1`: letters only where a digit ends them, and no identifier such as `ad0`.
bool is_channel(std::string_view text) {
  const auto bare = bare_value(text);
  if (all_digits(bare)) return bare.size() <= 2;
  return bare.size() > 2 && bare.size() < 16 && bare.back() >= '0' && bare.back() <= '9' &&
         !parse_log_id(bare) && bare.find_first_of("#=.:") == std::string_view::npos;
}

/// Three digits at least, or marked: shorter ones are bytes.
bool is_identifier(std::string_view text) {
  const auto id = parse_log_id(text);
  return id && (id->base != 0 || id->extended || id->digits.size() >= 3);
}

/// One digit, or marked: `8`, `[8]`, `DLC=8`.
bool is_length(std::string_view text) {
  return text.size() == 1 || text.find_first_of("[(=:") != std::string_view::npos;
}

bool is_time(std::string_view text) {
  return text.find_first_of(".:") != std::string_view::npos &&
         parse_log_time(text, TimeUnit::open).has_value();
}

/// A byte, or all of them without blanks between.
bool is_bytes(std::string_view text) {
  if (starts_with_nocase(text, "0x")) text.remove_prefix(2);
  return text.size() <= 16 && parse_digits(text, 16) && (text.size() <= 3 || text.size() % 2 == 0);
}

/// Whether a word of a line is what a word of a pattern asks for; then it goes to its cell.
bool take_word(std::string_view what, std::string_view text, LogCells& out) {
  if (what.starts_with('=')) {
    const auto words = split(what.substr(1), '|');
    const bool found =
        std::any_of(words.begin(), words.end(), [&](auto word) { return equals_nocase(word, text); });
    out.words.remote = out.words.remote || (found && equals_nocase(text, "r"));
    out.words.error = out.words.error || (found && equals_nocase(text, "ErrorFrame"));
    return found;
  }
  if (what == "any") return true;
  if (what == "number")
    return all_digits(text) || (text.ends_with(')') && all_digits(text.substr(0, text.size() - 1)));
  if (what == "time") return is_time(text) && (out.time = text, true);
  if (what == "clock")
    return is_time(text) && text.find(':') != std::string_view::npos && (out.time = text, true);
  if (what == "fraction") return is_time(text) && (out.fraction = text, true);
  if (what == "chan") return is_channel(text) && (out.channel = text, true);
  if (what == "dec") return all_digits(text) && (out.decimal_id = text, true);
  if (what == "id") return parse_log_id(text) && (out.id = text, true);
  if (what == "len") return parse_log_length(text) && (out.length = text, true);
  if (what == "dir")
    return is_direction(text) && (out.words.extended = out.words.extended || text.ends_with("29"), true);
  return what == "word" && read_log_words(text, out.words);
}

}  // namespace

std::span<const LogFormat> log_formats() { return kLogFormats; }

LogPattern::LogPattern(const LogFormat& format) : format_(&format) {
  std::vector<std::string_view> words;
  split_cells(format.pattern, ' ', words);
  for (auto what : words) {
    Word word{what, what.ends_with('?'), what.ends_with('*')};
    if (word.optional || word.repeats) word.what.remove_suffix(1);
    words_.push_back(word);
  }
}

bool LogPattern::match(std::string_view line, LogCells& out) {
  constexpr std::size_t kMostWords = 96;
  split_cells(line, ' ', line_);
  if (line_.size() > kMostWords) return false;
  out.clear();
  steps_ = 0;
  return match_from(0, 0, out);
}

/// What stands behind a frame is a remark, unless it could be more of its data.
bool LogPattern::is_tail(std::size_t at, const LogCells& cells) const {
  if (at == line_.size()) return true;
  if (std::string_view("#'\";/<").find(line_[at].front()) != std::string_view::npos) return true;
  return !cells.length.empty() && !is_bytes(line_[at]);
}

bool LogPattern::match_data(std::size_t word, std::size_t at, LogCells& out) {
  const auto length = parse_log_length(out.length);
  std::size_t count = 0;
  const auto packed = [&] {
    return *length > 1 && at < line_.size() && line_[at].size() == std::size_t{2} * *length;
  };
  if (length && !out.words.remote && packed()) {
    count = 1;
  } else if (length) {
    count = out.words.remote ? 0 : *length;
    if (count > line_.size() - at) return false;
  } else {
    while (at + count < line_.size() && is_bytes(line_[at + count])) ++count;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_bytes(line_[at + i])) return false;
    out.data.push_back(line_[at + i]);
  }
  return match_from(word + 1, at + count, out);
}

bool LogPattern::match_from(std::size_t word, std::size_t at, LogCells& out) {
  constexpr std::size_t kMostSteps = 2000;
  if (++steps_ > kMostSteps) return false;
  if (word == words_.size()) return is_tail(at, out);
  const auto& wanted = words_[word];
  if (wanted.what == "data") return match_data(word, at, out);
  // Where nothing of the tool is in the line, an identifier or a length must not look like a byte.
  const bool plain = format_->name == "plain" && at < line_.size();
  const bool odd = plain && ((wanted.what == "id" && !is_identifier(line_[at])) ||
                             (wanted.what == "len" && !is_length(line_[at])));
  const auto before = out;
  if (at < line_.size() && !odd && take_word(wanted.what, line_[at], out)) {
    if (match_from(wanted.repeats ? word : word + 1, at + 1, out)) return true;
  }
  out = before;
  return (wanted.optional || wanted.repeats) && match_from(word + 1, at, out);
}

}  // namespace servoctl::can
