// Frames and log lines in the notations of candump: what is read and written again is the same.
#include "can/candump.hpp"
#include "can/trace.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = fuzz::text(data, size);
  if (const auto frame = can::parse_frame(input)) {
    fuzz::require(frame->size <= 8, "a classical frame has at most 8 bytes");
    fuzz::require(can::parse_frame(can::to_string(*frame)) == frame, "a frame written is read again");
  }
  if (const auto line = can::parse_log_line(input))
    fuzz::require(can::parse_log_line(can::to_string(*line)) == line, "a line written is read again");
  if (const auto line = can::parse_candump_line(input)) {
    fuzz::require(line->frame.size <= 8, "a classical frame has at most 8 bytes");
    fuzz::require(line->frame.id <= 0x1FFF'FFFFU, "an identifier has at most 29 bits");
  }
  return 0;
}
