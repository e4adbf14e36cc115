#pragma once

#include <string_view>

#include "can/recording.hpp"

namespace servoctl::can {

/// Whether a file that begins like this is a binary log of Vector's tools.
bool is_blf(std::string_view beginning);

/// Reads the CAN frames and error frames of such a file: objects `LOBJ`, also in containers that zlib has
/// compressed (type 10). Types 1 and 86 are classical frames, 2 and 73 error frames, 100 and 101 those of CAN
/// FD channels, which may be classical; every other type is passed over. Times count from the beginning of
/// the measurement; channel 1 becomes `can1`. Vector publishes no description of the format: this follows
/// what others found out (python-can, Vector BLF of T. Lorenz).
///
/// A container that unpacks to more than it says, or than 64 MiB, is damage.
RecordingStrays read_blf(ByteWindow& bytes, const TakeLogFrame& take, const ReadOptions& options);

}  // namespace servoctl::can
