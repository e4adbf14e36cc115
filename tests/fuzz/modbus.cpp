// Bytes of a line, as answers to somebody who asks and as requests to a simulated drive, in each framing.
#include "modbus/client.hpp"

#include <algorithm>
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace servoctl;
using namespace servoctl::modbus;

constexpr TimePoint kStart{std::chrono::seconds(1)};
constexpr Duration kTimeout = std::chrono::milliseconds(100);

/// The bytes come in pieces, as the first of them says.
void feed(Framing framing, ByteSpan data) {
  const std::size_t piece = data.empty() ? 1 : 1U + data[0] % 16U;
  Client client(framing);
  Deframer requests(framing, Deframer::Expects::requests);
  auto now = kStart;
  for (std::size_t at = 0; at < data.size(); at += piece) {
    if (!client.busy()) {
      if (client.free_at(1) > now) now = client.free_at(1);
      (void)client.start(1, read_request(Function::read_registers, data[at], 1), now, kTimeout);
    }
    const auto part = data.subspan(at, std::min(piece, data.size() - at));
    now += std::chrono::milliseconds(1);
    client.on_bytes(part, now);
    client.on_time(now);
    if (const auto outcome = client.take_outcome(); outcome && outcome->kind == Outcome::Kind::answered)
      fuzz::require(outcome->pdu.size() == 4, "an answer has what was asked for");
    if (client.broken()) client.reset();
    requests.push(part);
    while (const auto message = requests.take())
      fuzz::require(!message->pdu.empty() && message->pdu.size() <= 255,
                    "a message is not longer than a frame");
    if (part.front() % 7 == 0) requests.on_silence();
    if (requests.broken()) requests.clear();
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const auto framing : {Framing::rtu, Framing::ascii, Framing::tcp}) feed(framing, {data, size});
  return 0;
}
