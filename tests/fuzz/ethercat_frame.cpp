// Frames, mailboxes and SII images of any content, and a ring that is given frames of others for its own.
#include "ethercat/frame.hpp"
#include "ethercat/mailbox_message.hpp"
#include "ethercat/ring.hpp"
#include "ethercat/sii_image.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

namespace {

bool lies_in(ByteSpan part, ByteSpan whole) {
  return part.empty() ||
         (part.data() >= whole.data() && part.data() + part.size() <= whole.data() + whole.size());
}

void read_frame(ByteSpan bytes) {
  auto reader = ethercat::FrameReader::open(bytes);
  if (!reader) {
    fuzz::require(!reader.error().message.text().empty(), "a refusal says why");
    return;
  }
  std::size_t count = 0;
  Bytes copy(bytes.begin(), bytes.end());
  while (const auto datagram = reader->next()) {
    fuzz::require(lies_in(datagram->data, bytes), "data lie in the frame");
    ethercat::set_working_counter(copy, *datagram, 7);
    fuzz::require(ethercat::data_of(copy, *datagram).size() == datagram->data.size(),
                  "it is changed in place");
    ++count;
  }
  fuzz::require(count > 0, "a frame that is taken has a datagram");
}

/// A frame of the ring's own comes back with some bytes changed.
void answer_ring(fuzz::Bytes& input) {
  TimePoint now{std::chrono::seconds(1)};
  ethercat::Ring ring{ethercat::Ring::Options{}};
  const auto slave = ethercat::SlaveAddress::station(0x1001);
  const auto first = ring.post(ethercat::read_registers(slave, 0x0130, 6));
  const auto second = ring.post(ethercat::write_once(slave, 0x1000, Bytes(32)));
  const auto sent = ring.take_frame(now);
  fuzz::require(first && second && sent, "the ring sends");
  Bytes frame(sent->begin(), sent->end());
  while (!input.empty()) {
    const auto at = static_cast<std::size_t>(input.next());
    frame[at % frame.size()] = input.next();
    ring.on_frame(frame, now);
  }
  for (int tries = 0; tries < 4; ++tries) {
    now += std::chrono::milliseconds(20);
    ring.on_time(now);
    while (ring.take_frame(now)) {
    }
  }
  fuzz::require(ring.take_answer(*first) && ring.take_answer(*second), "every datagram has an end");
  fuzz::require(ring.deadline() == kNever, "a ring with nothing under way waits for nothing");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ByteSpan bytes(data, size);
  read_frame(bytes);
  if (const auto message = ethercat::parse_mailbox(bytes))
    fuzz::require(lies_in(message->data, bytes), "in the mailbox");
  const auto image = ethercat::parse_sii(bytes);
  fuzz::require(image.strings.size() <= 255U * (1 + size / 4), "memory is bounded");
  fuzz::Bytes input(data, size);
  answer_ring(input);
  return 0;
}
