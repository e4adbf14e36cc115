// Logs of frames nobody meant: every frame is explained in one line, whatever mappings the log claims.
#include "base/text.hpp"
#include "can/trace.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "traffic/frame_decoder.hpp"

using namespace servoctl;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  traffic::FrameDecoder decoder({});
  for (const auto row : split(fuzz::text(data, size), '\n')) {
    const auto line = can::parse_log_line(row);
    if (!line) continue;
    const auto& decoded = decoder.decode(line->frame);
    fuzz::require(!decoded.text.empty(), "every frame is explained");
    fuzz::require(report::parse_json("{" + decoded.fields + "}", "fields").has_value(), "… and JSON");
  }
  return 0;
}
