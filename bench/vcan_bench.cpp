// SDO reads over a real interface: a loop of nothing but send() and read() beside our session, against the
// same drive. usage: servoctl_vcan_bench INTERFACE NODE READS
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "session/open_bus.hpp"
#include "session/session.hpp"

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Reads per second; ends the program when something fails.
double raw_loop(const char* interface, unsigned node, int reads) {
  const int fd = ::socket(PF_CAN, SOCK_RAW, CAN_RAW);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(interface));
  if (fd < 0 || ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) std::exit(3);
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
  const auto rate = reads / seconds_since(begin);
  ::close(fd);
  return rate;
}

double session_loop(const char* interface, unsigned node, int reads) {
  using namespace servoctl;
  auto bus = session::open_bus(interface, {});
  if (!bus) std::exit(3);
  session::Session session(std::move(*bus), interface, {});
  const auto begin = Clock::now();
  for (int i = 0; i < reads; ++i)
    if (!session.upload(static_cast<std::uint8_t>(node), {0x6041, 0})) std::exit(3);
  return reads / seconds_since(begin);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const auto node = static_cast<unsigned>(std::atoi(argv[2]));
  const int reads = std::atoi(argv[3]);
  (void)raw_loop(argv[1], node, reads / 10);
  double raw = 0;
  double ours = 0;
  for (int round = 0; round < 5; ++round) {
    raw += raw_loop(argv[1], node, reads / 5) / 5;
    ours += session_loop(argv[1], node, reads / 5) / 5;
  }
  std::printf("SDO reads per second: raw loop %.0f, session %.0f: %.0f %%\n", raw, ours, 100 * ours / raw);
  return 0;
}
