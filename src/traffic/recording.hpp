#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "can/recording.hpp"

/// Files of recorded frames: read, and what is to be said of them.
namespace servoctl::traffic {

using Strays = can::RecordingStrays;
using can::for_each_frame;

/// The content of a recording. Errc::file when it cannot be read.
Result<std::string> read_recording(std::string_view path);

/// What a user has to know of the lines or records that were left out.
std::vector<Message> notices(std::string_view path, const Strays& strays);

/// Errc::file for a recording that is damaged; nothing for any other.
Result<void> check_damage(std::string_view path, const Strays& strays);

/// Errc::usage where a recording does not say in which base its numbers are.
Result<void> check_base(std::string_view path, const Strays& strays);
/// Also where the base was only concluded: for what sends frames.
Result<void> check_base_is_certain(std::string_view path, const Strays& strays);

/// Whether a recording is one of a single bus, or `channel` names one of its buses, as `decode` shows them.
/// Errc::usage otherwise, with those that there are. Frames of several buses mean nothing on one.
Result<void> check_channel(std::string_view path, std::string_view recording, std::string_view channel,
                           const can::ReadOptions& options = {});

/// The frames of one bus of a recording; of all where `channel` is empty.
Strays for_each_frame_of(std::string_view recording, std::string_view channel, const can::TakeLogFrame& take,
                         const can::ReadOptions& options = {});

tl::unexpected<Error> no_frames(std::string_view path, const Strays& strays);

}  // namespace servoctl::traffic
