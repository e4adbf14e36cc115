#pragma once

#include <sys/types.h>

#include <string>

namespace servoctl::ethernet {

/// The process at the other end of a connected Unix socket; 0 where that cannot be known. Of a listening one
/// it is the process that listens.
::pid_t peer_process(int socket);

/// `process 4711 (servoctl sim sv2@1)`; `another process` for 0.
std::string process_words(::pid_t process);

}  // namespace servoctl::ethernet
