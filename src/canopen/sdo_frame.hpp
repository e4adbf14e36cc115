#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/object_address.hpp"
#include "can/frame.hpp"

namespace servoctl::canopen {

/// Builds and reads the fields that all SDO frames share (CiA 301, 7.2.4.3): byte 0 command specifier, bytes
/// 1 and 2 index, byte 3 sub-index, bytes 4 to 7 data, size or abort code.
can::Frame sdo_frame(std::uint32_t cob_id, std::uint8_t command, ObjectAddress object,
                     std::uint32_t data = 0);

/// A segment: byte 0 command specifier, the rest data.
can::Frame sdo_segment(std::uint32_t cob_id, std::uint8_t command);

ObjectAddress sdo_object(const can::Frame& frame);
std::uint32_t sdo_data(const can::Frame& frame);

/// The first frame of a write over the default SDO channel of a node (CiA 301, 7.2.4.3.3 and 7.2.4.3.9).
struct SdoWriteRequest {
  std::uint8_t node = 0;
  ObjectAddress object;
};
std::optional<SdoWriteRequest> sdo_write_request(const can::Frame& frame);

/// More than any object of a drive holds; ends a server that never sends its last segment.
inline constexpr std::size_t kMaxSdoUpload = std::size_t{64} << 20U;

/// A domain larger than this is refused: the server keeps a download in memory until its last segment.
inline constexpr std::size_t kMaxSdoDownload = std::size_t{16} << 20U;

/// Byte 0 of an abort, from either side.
inline constexpr std::uint8_t kSdoAbortCommand = 0x80;

/// Of byte 0 of a segment.
inline constexpr std::uint8_t kToggleBit = 0x10;

/// Of byte 0 where a block transfer begins, from either side.
inline constexpr std::uint8_t kCrcSupported = 0x04;

}  // namespace servoctl::canopen
