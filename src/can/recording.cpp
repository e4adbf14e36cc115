#include "can/recording.hpp"

#include <algorithm>

#include "base/format.hpp"
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
  const auto* const begin = content.data();
  const bool has_end = content.ends_with('\n');
  std::string_view line;
  for (std::size_t number = 1; take_log_line(content, line); ++number) {
    const auto read = asc ? asc_reader.read(line) : trc ? trc_reader.read(line) : read_candump(line);
    // Half a frame is a shorter one.
    if (content.empty() && !has_end && read.kind != AscLine::Kind::remark) {
      out.damage = {static_cast<std::uint64_t>(line.data() - begin), "its last line has no end"};
      break;
    }
    if (read.kind == AscLine::Kind::frame && !take(read.frame)) break;
    out.unsuited += read.kind == AscLine::Kind::unsuited;
    if (read.kind == AscLine::Kind::malformed) out.add_unknown(number);
  }
  return out;
}

std::map<std::string, std::size_t> frames_of_buses(std::string_view content) {
  std::map<std::string, std::size_t> out;
  (void)for_each_frame(content, [&](const LogFrame& line) {
    if (!line.frame.error) ++out[line.interface_name];
    return true;
  });
  return out;
}

std::string list_of(const std::map<std::string, std::size_t>& buses) {
  std::string out;
  for (const auto& [name, count] : buses) servoctl::append(out, formatted("{} ({})", name, count));
  return out;
}

}  // namespace servoctl::can
