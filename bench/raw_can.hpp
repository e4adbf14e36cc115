#pragma once

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>

namespace servoctl::bench {

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// How long so many SDO reads of the statusword take on a bus with nothing but write() and read(): the floor.
/// Ends the program when something fails.
inline double raw_reads(int fd, unsigned node, int reads) {
  can_frame request{};
  request.can_id = 0x600 + node;
  request.can_dlc = 8;
  const unsigned char command[8] = {0x40, 0x41, 0x60, 0};
  std::memcpy(request.data, command, sizeof command);
  const auto begin = Clock::now();
  for (int i = 0; i < reads; ++i) {
    if (::write(fd, &request, sizeof request) != sizeof request) std::exit(3);
    can_frame answer{};
    do {
      if (::read(fd, &answer, sizeof answer) != sizeof answer) std::exit(3);
    } while (answer.can_id != 0x580 + node);
  }
  return seconds_since(begin);
}

/// The same on an interface.
inline double raw_reads(const char* interface, unsigned node, int reads) {
  const int fd = ::socket(PF_CAN, SOCK_RAW, CAN_RAW);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(interface));
  if (fd < 0 || ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) std::exit(3);
  const auto out = raw_reads(fd, node, reads);
  ::close(fd);
  return out;
}

}  // namespace servoctl::bench
