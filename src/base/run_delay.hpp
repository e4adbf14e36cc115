#pragma once

#include <optional>
#include <string_view>

#include "base/time.hpp"

namespace servoctl {

/// How long the calling thread was ready to run and got no processor, since it began: its own lateness, which
/// is no drive's. Zero where the kernel does not count it.
Duration run_delay();

/// The same out of what stands in /proc/thread-self/schedstat; empty where it is nothing of the kind.
std::optional<Duration> parse_run_delay(std::string_view text);

}  // namespace servoctl
