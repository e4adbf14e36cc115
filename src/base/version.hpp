#pragma once

#include <string_view>

namespace servoctl {

/// The version of the program: `0.2.0` for the commit with the tag v0.2.0, `0.2.0+5.g1a2b3c4` for the fifth
/// commit after it, `0.2.0~312.g1a2b3c4` where no commit has such a tag yet, `0.2.0` for sources without git,
/// `0.2.0~unknown` where git tells nothing of them; `.dirty` behind a commit says that the sources were
/// changed. Every executable has an object of its own with these two (CMakeLists.txt), so that a commit costs
/// that object only.
std::string_view version();

/// Day of the commit, or of the newest changelog for sources without git: `2026-11-23`.
std::string_view version_date();

}  // namespace servoctl
