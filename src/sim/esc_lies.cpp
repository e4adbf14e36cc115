#include "sim/esc_lies.hpp"

#include <algorithm>

#include "ethercat/frame.hpp"

namespace servoctl::sim {
namespace {

constexpr std::uint16_t kRead = 1;  ///< What a slave adds to the working counter for inputs.
constexpr std::uint16_t kSenseless = 0xFFFF;

bool brings_inputs(ethercat::Command command) {
  return command == ethercat::Command::lrw || command == ethercat::Command::lrd;
}

}  // namespace

void add_lie(EscFaults& faults, std::string_view word) {
  if (word == "wkc") faults.withholds_inputs = true;
  if (word == "wkc-max") faults.senseless_counter = true;
  if (word == "silent-mailbox") faults.silent_mailbox = true;
  if (word == "frozen-inputs") faults.frozen_inputs = true;
  if (word == "frozen-outputs") faults.frozen_outputs = true;
  if (word == "al-state") faults.frozen_state = true;
}

void falsify_process_data(std::span<std::uint8_t> frame, ByteSpan before, const EscFaults& faults) {
  if (!faults.withholds_inputs && !faults.senseless_counter) return;
  auto now = ethercat::FrameReader::open(frame);
  auto then = ethercat::FrameReader::open(before);
  if (!now || !then) return;
  for (;;) {
    const auto datagram = now->next();
    const auto sent = then->next();
    if (!datagram || !sent) return;
    if (!is_logical(datagram->command) || datagram->working_counter == sent->working_counter) continue;
    auto counter = datagram->working_counter;
    if (faults.withholds_inputs && brings_inputs(datagram->command)) {
      counter = static_cast<std::uint16_t>(counter - kRead);
      std::copy(sent->data.begin(), sent->data.end(), data_of(frame, *datagram).begin());
    }
    if (faults.senseless_counter) counter = kSenseless;
    set_working_counter(frame, *datagram, counter);
  }
}

}  // namespace servoctl::sim
