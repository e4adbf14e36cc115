#include "can/recording.hpp"

#include <algorithm>

#include "base/text.hpp"
#include "can/asc.hpp"
#include "can/blf.hpp"
#include "can/candump.hpp"
#include "can/pcap.hpp"
#include "can/trc.hpp"

namespace servoctl::can {
namespace {

/// The next line without its line break; false at the end of the text.
bool take_log_line(std::string_view& text, std::string_view& line) {
  if (text.empty()) return false;
  const auto end = std::min(text.find('\n'), text.size());
  line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return true;
}

AscLine read_candump(std::string_view line) {
  AscLine out;
  if (auto logged = parse_log_line(line)) {
    out = {AscLine::Kind::frame, std::move(*logged)};
  } else if (auto shown = parse_candump_line(line)) {
    out = {AscLine::Kind::frame, std::move(*shown)};
  } else if (!trim(line).empty()) {
    out.kind = is_candump_fd(line) ? AscLine::Kind::unsuited : AscLine::Kind::malformed;
  }
  return out;
}

}  // namespace

RecordingStrays for_each_frame(std::string_view content, const TakeLogFrame& take) {
  if (is_pcap(content)) return read_pcap(content, take);
  if (is_blf(content)) return read_blf(content, take);
  const bool asc = is_asc(content);
  const bool trc = !asc && is_trc(content);
  AscReader asc_reader;
  TrcReader trc_reader;
  RecordingStrays out;
  std::string_view line;
  for (std::size_t number = 1; take_log_line(content, line); ++number) {
    const auto read = asc ? asc_reader.read(line) : trc ? trc_reader.read(line) : read_candump(line);
    if (read.kind == AscLine::Kind::frame && !take(read.frame)) break;
    out.unsuited += read.kind == AscLine::Kind::unsuited;
    if (read.kind == AscLine::Kind::malformed) out.add_unknown(number);
  }
  return out;
}

}  // namespace servoctl::can
