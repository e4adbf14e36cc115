#pragma once

#include "can/recording.hpp"

namespace servoctl::can {

/// Reads a recording in lines of text: of candump, .asc, .trc, a table whose header line or user names the
/// columns, or one of log_formats(). Which of them it is, its first lines decide: the first one that can be
/// nothing else, or else the one that most of them fit. Numbers whose base the recording does not tell are
/// not guessed: RecordingStrays::open_base.
RecordingStrays read_text(ByteWindow& bytes, const TakeLogFrame& take, const ReadOptions& options);

}  // namespace servoctl::can
