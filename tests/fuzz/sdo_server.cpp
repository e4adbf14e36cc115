// An SDO server against a client that sends anything.
#include "canopen/sdo_server.hpp"

#include <algorithm>

#include "canopen/sdo_frame.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

namespace {

constexpr std::uint8_t kNode = 2;

class Store final : public canopen::ObjectStore {
 public:
  std::uint32_t read(ObjectAddress object, Bytes& out) override {
    out.assign(object.sub * 9U, object.sub);
    return object.index == 0 ? 0x0602'0000 : 0;
  }
  std::uint32_t write(ObjectAddress object, ByteSpan data) override {
    fuzz::require(data.size() <= canopen::kMaxSdoDownload + 7, "memory is bounded");
    return object.index == 0 ? 0x0602'0000 : 0;
  }
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes input(data, size);
  Store store;
  canopen::SdoServer::Options options;
  const auto choice = input.next();
  options.segmented = (choice & 1U) != 0;
  options.block = (choice & 2U) != 0;
  options.crc = (choice & 4U) != 0;
  options.block_size = static_cast<std::uint8_t>(1 + (choice >> 3U));
  canopen::SdoServer server(kNode, store, options);
  TimePoint now{std::chrono::seconds(1)};
  while (!input.empty()) {
    const auto kind = input.next();
    if ((kind & 0x80U) != 0) {
      now = std::max(now, std::min(server.deadline(), now + std::chrono::milliseconds(kind)));
      server.on_time(now);
    } else {
      can::Frame frame;
      frame.id = 0x600U + kNode;
      frame.size = (kind & 0x40U) != 0 ? kind % 9 : 8;
      for (auto& byte : frame.data) byte = input.next();
      server.on_frame(frame, now);
    }
    for (int frames = 0; const auto answer = server.take_frame(); ++frames) {
      fuzz::require(frames < 130, "a server sends at most one block at a time");
      fuzz::require(answer->id == 0x580U + kNode && answer->size == 8, "an answer has 8 bytes");
    }
  }
  for (int steps = 0; server.deadline() != kNever; ++steps) {
    fuzz::require(steps < 5, "a silent client ends every transfer");
    now = std::max(now, server.deadline());
    server.on_time(now);
    while (server.take_frame()) {
    }
  }
  return 0;
}
