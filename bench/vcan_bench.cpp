// SDO reads over a real interface: a loop of nothing but send() and read() beside our session, against the
// same drive. INTERFACE `pair`: no bus but two sockets, behind the other of which a process answers, so that
// it runs where there is no CAN and the clock is no system call. usage: servoctl_vcan_bench INTERFACE NODE
// READS
#include <fcntl.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "can/socketcan.hpp"
#include "raw_can.hpp"
#include "session/open_bus.hpp"
#include "session/session.hpp"

namespace servoctl::bench {
namespace {

double session_loop(const char* interface, unsigned node, int reads) {
  auto bus = session::open_bus(interface, {});
  if (!bus) std::exit(3);
  session::Session session(std::move(*bus), interface, {});
  const auto begin = Clock::now();
  for (int i = 0; i < reads; ++i)
    if (!session.upload(static_cast<std::uint8_t>(node), {0x6041, 0})) std::exit(3);
  return reads / seconds_since(begin);
}

/// Answers each request for the statusword until the other end is closed.
[[noreturn]] void answer(int fd) {
  can_frame frame{};
  while (::read(fd, &frame, sizeof frame) == sizeof frame) {
    frame.can_id -= 0x80;
    frame.data[0] = 0x4B;
    frame.data[4] = 0x70;
    if (::write(fd, &frame, sizeof frame) != sizeof frame) break;
  }
  ::_exit(0);
}

int run_pair(unsigned node, int reads) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) return 3;
  if (::fork() == 0) {
    ::close(ends[0]);
    answer(ends[1]);
  }
  ::close(ends[1]);
  session::Session session(std::make_unique<can::SocketCanBus>(can::Descriptor(::dup(ends[0])), "pair"),
                           "pair", {});
  double raw = 1e9;
  double ours = 1e9;
  for (int round = 0; round < 20; ++round) {
    raw = std::min(raw, raw_reads(ends[0], node, reads / 20));
    const auto begin = Clock::now();
    for (int i = 0; i < reads / 20; ++i)
      if (!session.upload(static_cast<std::uint8_t>(node), {0x6041, 0})) return 3;
    ours = std::min(ours, seconds_since(begin));
  }
  const double each = reads / 20;
  std::printf("SDO reads between two sockets, best of 20: raw loop %.2f us, session %.2f us: %.0f %%\n",
              raw * 1e6 / each, ours * 1e6 / each, 100 * raw / ours);
  return 0;
}

int run(const char* interface, unsigned node, int reads) {
  (void)raw_reads(interface, node, reads / 10);
  double raw = 0;
  double ours = 0;
  for (int round = 0; round < 5; ++round) {
    raw += reads / 5 / raw_reads(interface, node, reads / 5) / 5;
    ours += session_loop(interface, node, reads / 5) / 5;
  }
  std::printf("SDO reads per second: raw loop %.0f, session %.0f: %.0f %%\n", raw, ours, 100 * ours / raw);
  return 0;
}

}  // namespace
}  // namespace servoctl::bench

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  if (std::string_view(argv[1]) == "pair")
    return servoctl::bench::run_pair(static_cast<unsigned>(std::atoi(argv[2])), std::atoi(argv[3]));
  return servoctl::bench::run(argv[1], static_cast<unsigned>(std::atoi(argv[2])), std::atoi(argv[3]));
}
