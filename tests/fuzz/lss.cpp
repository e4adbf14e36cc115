// The master of LSS against slaves that answer anything: any request, one after the other.
#include "canopen/lss_master.hpp"

#include <algorithm>
#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

namespace {

can::Frame next_frame(fuzz::Bytes& input, std::uint8_t kind) {
  can::Frame frame;
  frame.id = (kind & 0x20U) != 0 ? input.next() * 8U : canopen::kLssAnswer;
  frame.size = (kind & 0x40U) != 0 ? input.next() % 9 : std::uint8_t{8};
  for (auto& byte : frame.data) byte = input.next();
  if ((kind & 0x10U) == 0) frame.data[0] = 0x4F;  // Most answers are what fastscan asks for.
  frame.remote = (kind & 0x0FU) == 15;
  frame.extended = (kind & 0x0FU) == 14;
  (void)canopen::parse_lss_answer(frame);
  return frame;
}

canopen::LssRequest next_request(fuzz::Bytes& input) {
  const canopen::LssAddress address{input.next(), input.next(), input.next(), input.next()};
  switch (input.next() % 9) {
    case 0: return canopen::lss_switch_all(canopen::LssState::configuration);
    case 1: return canopen::lss_select(address);
    case 2: return canopen::lss_set_node(input.next());
    case 3: return canopen::lss_set_bit_timing(input.next());
    case 4: return canopen::lss_store();
    case 5: return canopen::lss_identify(address, address);
    case 6: return canopen::lss_fastscan({input.next(), input.next(), input.next(), input.next()});
    case 7: return canopen::lss_activate_bit_timing(input.next());
    default: return canopen::lss_inquire(canopen::LssService::inquire_serial);
  }
}

/// Gives the machine frames and time until it has a result; a silent bus ends it in any case.
template <class Machine>
auto drive(Machine& machine, fuzz::Bytes& input, TimePoint& now) {
  for (int steps = 0; steps < 100'000; ++steps) {
    for (int frames = 0; const auto frame = machine.take_frame(); ++frames) {
      fuzz::require(frames < 2, "one frame at a time");
      fuzz::require(frame->id == canopen::kLssRequest && frame->size == 8, "a request has 8 bytes");
    }
    if (auto result = machine.take_result()) return result;
    const auto kind = input.next();
    if ((kind & 0x80U) == 0 && !input.empty()) {
      machine.on_frame(next_frame(input, kind), now);
      continue;
    }
    fuzz::require(machine.deadline() != kNever, "what is under way has a deadline");
    now = std::max(now, machine.deadline());
    machine.on_time(now);
  }
  fuzz::require(false, "every request ends");
  return machine.take_result();
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes input(data, size);
  TimePoint now{std::chrono::seconds(1)};
  canopen::LssMaster master({});
  while (!input.empty()) {
    master.start(next_request(input), now);
    const auto answers = drive(master, input, now);
    fuzz::require(answers->size() <= canopen::LssMaster::kMostAnswers, "memory is bounded");
    fuzz::require(!master.busy() && master.deadline() == kNever, "an idle master waits for nothing");
    for (const auto& answer : *answers) (void)canopen::lss_error_text(answer);
  }
  return 0;
}
