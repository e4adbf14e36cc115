#include "can/text_recording.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <string>
#include <vector>

#include "base/text.hpp"
#include "can/asc.hpp"
#include "can/candump.hpp"
#include "can/log_choice.hpp"
#include "can/text_lines.hpp"
#include "can/trc.hpp"

namespace servoctl::can {
namespace {

using Form = LogChoice::Form;

constexpr std::size_t kSampleLines = 200;
constexpr std::size_t kSampleBytes = std::size_t{64} << 10U;

/// No recording since then was made by a clock that counts from 1970 and shows less.
constexpr Duration kSince1970 = std::chrono::hours(24 * 365 * 3);

/// Which frames came so far with how many bytes: a last line without an end may be cut short.
class SeenSizes {
 public:
  SeenSizes() { sizes_.fill(kNone); }
  void add(const Frame& frame) {
    if (!frame.extended && !frame.error) sizes_[frame.id] = frame.size;
  }
  bool has(const Frame& frame) const {
    return !frame.extended && !frame.error && sizes_[frame.id] == frame.size;
  }

 private:
  static constexpr std::uint8_t kNone = 0xFF;
  std::array<std::uint8_t, 0x800> sizes_{};
};

/// Reads the lines of a text whose form is known.
class LineReader {
 public:
  explicit LineReader(const LogChoice& choice) : form_(choice.form()), relative_(choice.relative_candump()) {
    if (form_ == Form::columns) columns_ = choice.columns();
    if (form_ == Form::columns || form_ == Form::format) numbers_ = choice.numbers();
    if (form_ == Form::format)
      for (const auto* format : choice.formats()) patterns_.emplace_back(*format);
    if (choice.day()) row_.set_day(*choice.day());
    header_ = choice.header();
  }

  AscLine read(const TextLine& line) {
    length_told_ = true;
    switch (form_) {
      case Form::asc: return asc_.read(line.text);
      case Form::trc: return trc_.read(line.text);
      case Form::columns: return read_columns(line);
      case Form::format: return read_format(line.text);
      case Form::candump:
      case Form::none: break;
    }
    return read_line_of_candump(line.text);
  }

  /// Of the frame read last: whether the line can be trusted although it has no end.
  bool is_whole(std::string_view line, const Frame& frame, const SeenSizes& seen) const {
    line = trim(line);
    const auto last = line.find_last_of(" \t,;#");
    const auto word = last == std::string_view::npos ? line : line.substr(last + 1);
    const bool half_byte = word.size() == 1 && word.find_first_of("0123456789abcdefABCDEF") == 0;
    if (form_ == Form::asc || form_ == Form::trc) return false;
    if (frame.error || frame.remote) return true;
    const bool decimal = form_ != Form::candump && numbers_.data_base != 16;
    if (half_byte || decimal || (form_ == Form::columns && !has_all_cells())) return false;
    return length_told_ || frame.size == frame.data.size() || seen.has(frame);
  }

  /// Whether other columns begin with the line that was read last.
  bool columns_change() const { return columns_change_; }

  LogClock clock() const {
    if (form_ == Form::asc) return asc_.clock();
    if (form_ == Form::trc) return trc_.clock();
    return form_ == Form::candump ? clock_ : row_.clock();
  }
  bool lacks_unit() const { return row_.lacks_unit(); }

 private:
  /// Whether the line read last has a cell for each column that tells something, the last of them in full.
  bool has_all_cells() const {
    std::size_t last = columns_.roles.size();
    while (last > 0 && columns_.roles[last - 1] == LogRole::skip) --last;
    const bool ends_in_data =
        last > 0 && (columns_.roles[last - 1] == LogRole::data || columns_.roles[last - 1] == LogRole::byte);
    return cells_.size() > last || (cells_.size() == last && ends_in_data);
  }

  AscLine read_line_of_candump(std::string_view line) {
    auto out = read_candump(line);
    length_told_ = line.find('[') != std::string_view::npos;
    auto& time = out.frame.time;
    if (out.kind == AscLine::Kind::frame && relative_) time = time_ += time;
    const bool dated = line.find('-') < line.find(')');
    clock_.kind = time < kSince1970 ? LogClock::Kind::none
                  : dated           ? LogClock::Kind::local
                                    : LogClock::Kind::utc;
    return out;
  }

  AscLine read_columns(const TextLine& line) {
    if (line.number == header_) named_ = read_column_names(line.text);
    if (line.number <= header_ || trim(line.text).empty()) return {};
    split_cells(line.text, columns_.separator, cells_);
    if (const auto others = read_column_names(line.text); others && named_ && *others != *named_)
      columns_change_ = true;
    const bool placed = place_cells(columns_, cells_, line_);
    if (!placed && (is_log_remark(line.text) || names_columns(line.text))) return {};
    length_told_ = !line_.length.empty();
    const auto out = placed ? row_.read(line_, numbers_) : AscLine{AscLine::Kind::malformed, {}};
    const bool header =
        out.kind == AscLine::Kind::malformed && (is_log_remark(line.text) || names_columns(line.text));
    return header ? AscLine() : out;
  }

  AscLine read_format(std::string_view line) {
    take_mode(read_log_mode(line));
    if (is_log_remark(line)) return {};
    for (auto& pattern : patterns_) {
      if (!pattern.match(line, line_)) continue;
      length_told_ = !line_.length.empty();
      return row_.read(line_, numbers_);
    }
    if (names_columns(line)) return {};
    return {is_other_bus(line) ? AscLine::Kind::unsuited : AscLine::Kind::malformed, {}};
  }

  void take_mode(const LogMode& mode) {
    if (mode.base) numbers_.id_base = numbers_.data_base = *mode.base;
    if (mode.relative) numbers_.relative = *mode.relative;
    if (mode.day) row_.set_day(*mode.day);
  }

  static bool is_other_bus(std::string_view line) {
    const auto words = lower(line);
    return words.find("canfd") != std::string::npos || words.find(" fd ") != std::string::npos;
  }

  Form form_;
  bool relative_;
  std::size_t header_ = 0;
  AscReader asc_;
  TrcReader trc_;
  LogColumns columns_;
  std::optional<LogColumns> named_;  ///< As the header names them.
  bool columns_change_ = false;
  LogNumbers numbers_;
  std::vector<LogPattern> patterns_;
  std::vector<std::string_view> cells_;
  LogCells line_;
  LogRow row_;
  Duration time_{};
  LogClock clock_;
  bool length_told_ = true;
};

/// A line that has been looked at, and is still to be read.
struct KeptLine {
  std::string text;
  TextLine line;
};

class TextReader {
 public:
  TextReader(ByteWindow& bytes, const TakeLogFrame& take, const ReadOptions& options)
      : lines_(bytes), take_(&take), options_(&options), choice_(options.columns) {}

  RecordingStrays read() {
    look();
    const auto numbers = choice_.numbers();
    const bool rows = choice_.form() == Form::columns || choice_.form() == Form::format;
    if (rows && (numbers.id_base == 0 || numbers.data_base == 0)) {
      out_.open_base = choice_.header() + 1;
      return std::move(out_);
    }
    out_.of_table = rows;
    if (rows && choice_.assumed()) out_.assumed_base = numbers.id_base;
    if (rows && choice_.assumed_data()) out_.assumed_data_base = numbers.data_base;
    LineReader reader(choice_);
    TextLine line;
    bool more = true;
    while (more && take_kept(line)) more = read_one(reader, line);
    while (more && lines_.take(line)) more = read_one(reader, line);
    out_.lacks_unit = reader.lacks_unit();
    return std::move(out_);
  }

 private:
  void look() {
    std::size_t bytes = 0;
    TextLine line;
    while (kept_.size() < kSampleLines && bytes < kSampleBytes && lines_.take(line)) {
      bytes += line.text.size();
      kept_.push_back({std::string(line.text), line});
      if (choice_.look(line.text)) return;
    }
  }

  bool take_kept(TextLine& out) {
    if (read_ > 0) kept_.pop_front();
    read_ = kept_.empty() ? 0 : 1;
    if (kept_.empty()) return false;
    out = kept_.front().line;
    out.text = kept_.front().text;
    return true;
  }

  bool read_one(LineReader& reader, const TextLine& line) {
    const auto read = reader.read(line);
    const bool frame = read.kind == AscLine::Kind::frame;
    const bool cut = !line.ended && read.kind != AscLine::Kind::remark &&
                     !(frame && reader.is_whole(line.text, read.frame.frame, seen_));
    if (reader.columns_change()) {
      out_.damage = {line.offset, "other columns begin there", true};
      return false;
    }
    if (cut) {
      out_.damage = {line.offset, "its last line has no end"};
      return false;
    }
    out_.unsuited += read.kind == AscLine::Kind::unsuited;
    if (read.kind == AscLine::Kind::malformed) out_.add_unknown(line.number, line.text);
    if (!frame) return true;
    seen_.add(read.frame.frame);
    if (options_->clock != nullptr) *options_->clock = reader.clock();
    return (*take_)(read.frame);
  }

  TextLines lines_;
  const TakeLogFrame* take_;
  const ReadOptions* options_;
  LogChoice choice_;
  std::deque<KeptLine> kept_;
  std::size_t read_ = 0;
  SeenSizes seen_;
  RecordingStrays out_;
};

}  // namespace

RecordingStrays read_text(ByteWindow& bytes, const TakeLogFrame& take, const ReadOptions& options) {
  return TextReader(bytes, take, options).read();
}

}  // namespace servoctl::can
