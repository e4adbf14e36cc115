#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/bytes.hpp"
#include "base/time.hpp"

namespace servoctl::ethernet {

/// The two forms in which Wireshark keeps frames.
enum class PcapForm : std::uint8_t {
  classic,  ///< `.pcap`: time and bytes (draft-ietf-opsawg-pcap).
  next,     ///< `.pcapng`: the name of the interface and the direction as well (draft-ietf-opsawg-pcapng).
};

enum class Direction : std::uint8_t { received = 1, sent = 2 };

/// What such a file begins with; link type Ethernet, times in microseconds.
std::string pcap_head(PcapForm form, std::string_view interface_name);

/// One frame. `time` counts from 1970-01-01 UTC and is not negative.
std::string pcap_record(PcapForm form, Duration time, Direction direction, ByteSpan frame);

}  // namespace servoctl::ethernet
