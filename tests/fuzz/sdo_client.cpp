// An SDO client against a server that answers anything. The first bytes choose the transfer, then each step
// is a frame or a wait.
#include "canopen/sdo_client.hpp"

#include <algorithm>

#include "canopen/sdo_frame.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

namespace {

constexpr std::uint8_t kNode = 2;
constexpr ObjectAddress kObject{0x1F50, 1};

/// Takes what the client sends; a block of 127 segments and an abort is the most there can be.
void drain(canopen::SdoClient& client) {
  for (int frames = 0; const auto frame = client.take_frame(); ++frames) {
    fuzz::require(frames < 130, "a client sends at most one block at a time");
    fuzz::require(frame->id == 0x600U + kNode && frame->size == 8, "a request has 8 bytes");
  }
}

can::Frame next_frame(fuzz::Bytes& input, std::uint8_t kind) {
  can::Frame frame;
  frame.id = 0x580U + kNode;
  frame.size = 8;
  if ((kind & 0x40U) != 0) frame.size = input.next() % 9;
  if ((kind & 0x20U) != 0) frame.id = input.next() * 8U;
  for (auto& byte : frame.data) byte = input.next();
  if ((kind & 0x10U) == 0) {  // Most answers speak of the right object.
    frame.data[1] = 0x50;
    frame.data[2] = 0x1F;
    frame.data[3] = 1;
  }
  frame.remote = (kind & 0x0FU) == 15;
  frame.extended = (kind & 0x0FU) == 14;
  return frame;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes input(data, size);
  TimePoint now{std::chrono::seconds(1)};
  canopen::SdoClient client(kNode, std::chrono::milliseconds(500));
  while (!input.empty()) {
    const auto choice = input.next();
    const auto transfer = static_cast<canopen::Transfer>(choice % 5);
    if ((choice & 0x80U) != 0)
      client.start_upload(kObject, now, transfer, choice >> 5U & 0x03U);
    else
      client.start_download(kObject, Bytes(transfer == canopen::Transfer::expedited ? 4U : input.next() * 8U),
                            now, transfer);
    drain(client);
    for (int steps = 0; client.busy() && steps < 2000; ++steps) {
      const auto kind = input.next();
      if ((kind & 0x80U) != 0 || input.empty()) {
        now = std::max(now, std::min(client.deadline(), now + std::chrono::seconds(1)));
        client.on_time(now);
      } else {
        client.on_frame(next_frame(input, kind), now);
      }
      drain(client);
      fuzz::require(client.transferred() <= canopen::kMaxSdoUpload + 7, "memory is bounded");
    }
    fuzz::require(!client.busy() || !input.empty(), "a silent server ends every transfer");
    if (client.busy()) return 0;
    const auto result = client.take_result();
    fuzz::require(result.has_value(), "a transfer that ended has a result");
    fuzz::require(*result || result->error().node == kNode, "an error names its node");
    fuzz::require(!client.take_result(), "a transfer has one result");
    fuzz::require(client.deadline() == kNever, "an idle client waits for nothing");
  }
  return 0;
}
