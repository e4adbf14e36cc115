#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "can/trace.hpp"

/// Files of recorded frames, in the form of candump or as .asc.
namespace servoctl::traffic {

/// Lines of a recording that gave no frame.
struct Strays {
  std::size_t unknown = 0;     ///< No frame of any kind.
  std::size_t first_line = 0;  ///< Number of the first of them, from 1.
  std::size_t unsuited = 0;    ///< CAN FD, or another bus system.
};

/// The text of a recording. Errc::file when it cannot be read.
Result<std::string> read_recording(std::string_view path);

/// Calls `take` with each frame, in the order of the file, until it answers false.
Strays for_each_frame(std::string_view text, const std::function<bool(const can::LogFrame&)>& take);

/// What a user has to know of the lines that were left out.
std::vector<std::string> notices(std::string_view path, const Strays& strays);

tl::unexpected<Error> no_frames(std::string_view path);

}  // namespace servoctl::traffic
