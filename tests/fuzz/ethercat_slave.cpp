// A slave that answers anything: its mailbox with who speaks through it, its SII and its states, on a ring
// that loses frames.
#include "ethercat/al_request.hpp"
#include "ethercat/coe_slave.hpp"
#include "ethercat/registers.hpp"
#include "ethercat/sii_reader.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

namespace {

constexpr std::uint8_t kNode = 2;
constexpr ObjectAddress kObject{0x2000, 1};
constexpr ethercat::SiiMailbox kPlace{0x1000, 40, 0x1800, 40};
const auto kSlave = ethercat::SlaveAddress::station(0x1002);

/// Ring, clock and a slave made of the input: silent when that is used up.
class Wire {
 public:
  explicit Wire(fuzz::Bytes& input) : input_(&input) {}

  /// One frame there and back, if there is one.
  bool pass() {
    const auto sent = ring.take_frame(now);
    if (!sent) return false;
    now += std::chrono::microseconds(50);
    Bytes frame(sent->begin(), sent->end());
    auto reader = ethercat::FrameReader::open(*sent);
    fuzz::require(reader.has_value(), "what is sent can be read");
    const auto fate = input_->next();
    if (input_->empty() || fate % 16 == 15) return true;
    while (const auto datagram = reader->next()) answer(frame, *datagram, fate);
    ring.on_frame(frame, now);
    return true;
  }
  void wait(TimePoint deadline) {
    const auto next = std::min(deadline, ring.deadline());
    fuzz::require(next != kNever, "who waits has a deadline");
    now = std::max(now + std::chrono::microseconds(1), next);
    ring.on_time(now);
  }

  ethercat::Ring ring{ethercat::Ring::Options{}};
  TimePoint now{std::chrono::seconds(1)};

 private:
  void answer(Bytes& frame, const ethercat::Datagram& datagram, std::uint8_t fate) {
    ethercat::set_working_counter(frame, datagram, fate % 16 == 14 ? 0 : 1);
    auto data = ethercat::data_of(frame, datagram);
    if (datagram.command != ethercat::Command::fprd) return;
    if (datagram.ado() == kPlace.in_start) return fill_mailbox(data);
    for (auto& byte : data) byte = input_->next();
    // Most looks find something to read, and room to write.
    if (datagram.ado() == ethercat::reg::sm_status(0) && (fate & 0x10U) == 0) {
      data[0] = 0;
      data[8] = ethercat::reg::kSmFull;
    }
    if (datagram.ado() == ethercat::reg::kSiiControl && (fate & 0x20U) == 0) {
      data[1] = 0;
      if (data.size() > 6) store_le(sii_words_, data.subspan(2, 4));
      sii_words_ += 2;
    }
  }
  void fill_mailbox(std::span<std::uint8_t> data) {
    for (auto& byte : data.first(24)) byte = input_->next();
    const auto kind = data[0];
    if ((kind & 0x80U) != 0) return;
    store_le(kind % 34U, data.first(2));
    data[5] = static_cast<std::uint8_t>(3U | (data[5] & 0x70U));
    if ((kind & 0x40U) == 0) data[7] = 0x30;
    if ((kind & 0x20U) == 0) {
      data[9] = 0x00;
      data[10] = 0x20;
      data[11] = 1;
    }
  }

  fuzz::Bytes* input_;
  std::uint32_t sii_words_ = 0;
};

/// Drives one machine on the ring to its result.
template <class Machine>
void run(Machine& machine, Wire& wire) {
  ethercat::Carrier carrier;
  for (int steps = 0; machine.busy(); ++steps) {
    fuzz::require(steps < 200'000, "it comes to an end");
    while (carrier.serve(machine, wire.ring, wire.now)) {
    }
    if (!machine.busy()) break;
    if (wire.pass()) continue;
    wire.wait(machine.deadline());
    machine.on_time(wire.now);
  }
  const auto result = machine.take_result();
  fuzz::require(result.has_value() && !machine.take_result(), "it has one result");
  fuzz::require(*result || result->error().node == kNode, "an error names its node");
  fuzz::require(machine.deadline() == kNever, "what is idle waits for nothing");
}

void start(ethercat::CoeSlave& slave, std::uint8_t choice, fuzz::Bytes& input, TimePoint now) {
  switch (choice % 5) {
    case 0: return slave.client().start_upload(kObject, now);
    case 1: return slave.client().start_upload(kObject, now, canopen::Transfer::expedited);
    case 2: return slave.client().start_download(kObject, Bytes(input.next()), now);
    case 3: return slave.info().start_list(ethercat::ObjectList::all, now);
    default: return slave.info().start_entry(kObject, now);
  }
}

void talk(Wire& wire, fuzz::Bytes& input) {
  ethercat::CoeSlave slave(kNode, kSlave, ethercat::Mailbox::Options{kPlace}, std::chrono::milliseconds(100));
  slave.mailbox().start(wire.now);
  while (!input.empty()) {
    start(slave, input.next(), input, wire.now);
    for (int steps = 0; slave.client().busy() || slave.info().busy(); ++steps) {
      fuzz::require(steps < 200'000, "a transfer comes to an end");
      slave.serve(wire.ring, wire.now);
      while (slave.mailbox().take_emergency()) {
      }
      if (wire.pass()) continue;
      wire.wait(slave.deadline());
      slave.on_time(wire.now);
    }
    const auto data = slave.client().take_result();
    const auto described = slave.info().take_result();
    fuzz::require(data.has_value() != described.has_value(), "what ended has a result");
    if (data) fuzz::require(*data || data->error().node == kNode, "an error names its node");
  }
  slave.leave(wire.ring);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes input(data, size);
  Wire wire(input);
  const auto choice = input.next();
  if (choice % 4 == 0) {
    ethercat::SiiReader reader(kNode, kSlave);
    reader.start(wire.now);
    run(reader, wire);
  } else if (choice % 4 == 1) {
    ethercat::AlRequest request(kNode, kSlave);
    request.start(static_cast<ethercat::AlState>(choice >> 4U), wire.now);
    run(request, wire);
  } else {
    talk(wire, input);
  }
  return 0;
}
