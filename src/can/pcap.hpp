#pragma once

#include <string_view>

#include "can/recording.hpp"

namespace servoctl::can {

/// Whether a file that begins like this is a pcap or pcapng, of either byte order.
bool is_pcap(std::string_view beginning);

/// Reads the CAN frames of such a file (draft-ietf-opsawg-pcap, -pcapng): link types CAN_SOCKETCAN (227),
/// LINUX_SLL (113) and LINUX_SLL2 (276), whose identifiers are big-endian whatever the file is. Packets of
/// other link types and protocols, and CAN FD, are unsuited. Times are those of the file, since 1970. The
/// name of the interface is that of pcapng; without one it is `can0`, `can1` … by its number.
RecordingStrays read_pcap(ByteWindow& bytes, const TakeLogFrame& take, const ReadOptions& options);

}  // namespace servoctl::can
