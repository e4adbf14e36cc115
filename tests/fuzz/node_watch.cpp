// Emergencies, heartbeats and boot-ups of any content.
#include "canopen/node_watch.hpp"

#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes input(data, size);
  canopen::NodeWatch watch;
  TimePoint now{std::chrono::seconds(1)};
  while (!input.empty()) {
    const auto kind = input.next();
    now += std::chrono::milliseconds(input.next());
    can::Frame frame;
    frame.id = ((kind & 1U) != 0 ? 0x080U : 0x700U) + (kind >> 3U);
    frame.size = static_cast<std::uint8_t>((kind & 2U) != 0 ? 8U : input.next() % 9U);
    frame.remote = (kind & 4U) != 0 && input.next() == 0;
    for (auto& byte : frame.data) byte = input.next();
    if (const auto emergency = canopen::parse_emergency(frame)) {
      fuzz::require(emergency->node >= 1 && emergency->node <= 127, "an emergency comes from a node");
      fuzz::require(!canopen::emergency_text(emergency->code).empty(), "every code has a text");
      (void)canopen::error_register_text(emergency->error_register);
    }
    watch.on_frame(frame, now);
    watch.on_time(now);
    fuzz::require(watch.deadline() > now, "what was due is done");
  }
  while (const auto event = watch.take_event())
    fuzz::require(event->node >= 1 && event->node <= 127 && event->times >= 1, "an event comes from a node");
  return 0;
}
