#include "ethernet/frame_limits.hpp"

#include "base/format.hpp"

namespace servoctl::ethernet {

Result<void> check_frame(ByteSpan frame) {
  if (frame.size() >= kShortestFrame && frame.size() <= kLongestFrame) return {};
  return fail(Errc::bug, message("a frame that cannot be sent: {} bytes", frame.size()));
}

}  // namespace servoctl::ethernet
