// SDO reads over a real interface: a loop of nothing but send() and read() beside our session, against the
// same drive. usage: servoctl_vcan_bench INTERFACE NODE READS
#include <cstdio>
#include <cstdlib>

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
  return servoctl::bench::run(argv[1], static_cast<unsigned>(std::atoi(argv[2])), std::atoi(argv[3]));
}
