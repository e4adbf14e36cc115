// Logs in the .asc form: whatever a file holds, what is read are frames of a classical bus, and those are
// read again.
#include "can/asc.hpp"

#include "base/text.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = fuzz::text(data, size);
  (void)can::is_asc(input);
  can::AscReader reader;
  for (const auto row : split(std::string_view(input), '\n')) {
    const auto line = reader.read(row);
    if (line.kind != can::AscLine::Kind::frame) continue;
    fuzz::require(line.frame.frame.size <= 8, "a classical frame has at most 8 bytes");
    fuzz::require(line.frame.time >= Duration::zero(), "no time lies before the beginning");
    fuzz::require(can::parse_log_line(can::to_string(line.frame)) == line.frame,
                  "a frame written is read again");
  }
  return 0;
}
