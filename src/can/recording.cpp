#include "can/recording.hpp"

#include "base/format.hpp"
#include "base/text.hpp"
#include "can/blf.hpp"
#include "can/pcap.hpp"
#include "can/text_recording.hpp"

namespace servoctl::can {

RecordingStrays for_each_frame(ByteWindow& bytes, const TakeLogFrame& take, const ReadOptions& options) {
  constexpr std::size_t kMark = 4;
  const auto begin = bytes.ahead(kMark);
  if (is_pcap(begin)) return read_pcap(bytes, take, options);
  if (is_blf(begin)) return read_blf(bytes, take, options);
  return read_text(bytes, take, options);
}

RecordingStrays for_each_frame(std::string_view content, const TakeLogFrame& take,
                               const ReadOptions& options) {
  ByteWindow bytes(content);
  return for_each_frame(bytes, take, options);
}

std::map<std::string, std::size_t> frames_of_buses(std::string_view content, const ReadOptions& options) {
  std::map<std::string, std::size_t> out;
  const auto count = [&](const LogFrame& line) {
    if (!line.frame.error) ++out[line.interface_name];
    return true;
  };
  (void)for_each_frame(content, count, options);
  return out;
}

std::string list_of(const std::map<std::string, std::size_t>& buses) {
  std::string out;
  for (const auto& [name, count] : buses) servoctl::append(out, formatted("{} ({})", name, count));
  return out;
}

}  // namespace servoctl::can
