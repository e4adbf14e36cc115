// CoE over a virtual cable to simulated slaves in another process: SDO reads beside a loop of nothing but
// writing a mailbox, looking at it and reading it; and how late the cycles of OP are. usage:
// servoctl_coe_bench NAME READS
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "ethercat/frame.hpp"
#include "session/ethercat_network.hpp"
#include "session/open_port.hpp"
#include "session/session.hpp"
#include "sim/esc_cell.hpp"

namespace servoctl::bench {
namespace {

namespace ec = ethercat;

constexpr std::uint16_t kStation = 0x1001;
constexpr std::uint16_t kOut = 0x1000;
constexpr std::uint16_t kIn = 0x1400;
constexpr std::size_t kMailbox = 256;
const std::filesystem::path kFolders[] = {std::filesystem::path(SERVOCTL_SOURCE_DIR) / "eds"};

[[noreturn]] void serve(const std::string& url) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  auto port = session::open_ring_port(url, {});
  auto cell = sim::build_esc_cell("sv2@1", kFolders, steady_now());
  if (!port || !cell) ::_exit(3);
  auto& ring = cell->ring;
  for (;;) {
    const auto frame = (*port)->receive(ring.deadline());
    if (!frame) ::_exit(3);
    if (*frame) ring.on_frame(**frame, (*port)->now());
    ring.on_time((*port)->now());
    while (const auto back = ring.take_frame())
      if (!(*port)->send(*back)) ::_exit(3);
  }
}

/// A port that somebody else keeps, and notes when frames with process data were sent.
class Borrowed final : public ethernet::Port {
 public:
  explicit Borrowed(ethernet::Port& port) : port_(&port) {}
  TimePoint now() const override { return port_->now(); }
  Result<void> send(ByteSpan frame) override {
    if (frame[16] == static_cast<std::uint8_t>(ec::Command::lrw)) cycles.push_back(now());
    return port_->send(frame);
  }
  Result<std::optional<ByteSpan>> receive(TimePoint deadline) override { return port_->receive(deadline); }
  TimePoint arrived() const override { return port_->arrived(); }
  Result<void> recover(TimePoint deadline) override { return port_->recover(deadline); }

  std::vector<TimePoint> cycles;

 private:
  ethernet::Port* port_;
};

/// A frame with one datagram, its data behind byte 26.
Bytes frame_of(std::uint8_t command, std::uint16_t where, ByteSpan data) {
  Bytes out(std::max<std::size_t>(60, 28 + data.size()), 0);
  std::fill_n(out.begin(), 6, std::uint8_t{0xFF});
  out[6] = 2;
  out[12] = 0x88;
  out[13] = 0xA4;
  store_le((12 + data.size()) | 0x1000U, std::span(out).subspan(14, 2));
  out[16] = command;
  store_le(kStation, std::span(out).subspan(18, 2));
  store_le(where, std::span(out).subspan(20, 2));
  store_le(data.size(), std::span(out).subspan(22, 2));
  std::copy(data.begin(), data.end(), out.begin() + 26);
  return out;
}

[[noreturn]] void give_up(const char* why) {
  std::fprintf(stderr, "bare loop: %s\n", why);
  std::exit(3);
}

std::uint8_t ask(ethernet::Port& port, const Bytes& frame, std::size_t at) {
  if (!port.send(frame)) give_up("a frame was not taken");
  const auto back = port.receive(port.now() + std::chrono::seconds(1));
  if (!back || !*back) give_up("a frame did not come back");
  return (**back)[26 + at];
}

double bare_loop(ethernet::Port& port, int reads) {
  constexpr std::uint8_t kFprd = 4;
  constexpr std::uint8_t kFpwr = 5;
  Bytes request(kMailbox, 0);
  request[0] = 10;
  request[5] = 3;
  request[7] = 0x20;
  request[8] = 0x40;
  request[9] = 0x41;
  request[10] = 0x60;
  const auto write = frame_of(kFpwr, kOut, request);
  const auto look = frame_of(kFprd, 0x080D, Bytes(1));
  const auto read = frame_of(kFprd, kIn, Bytes(kMailbox));
  const auto begin = port.now();
  for (int i = 0; i < reads; ++i) {
    (void)ask(port, write, 0);
    while ((ask(port, look, 0) & 0x08U) == 0) {
    }
    if (ask(port, read, 8) != 0x4B) give_up("another answer than that to its read");
  }
  return std::chrono::duration<double>(port.now() - begin).count();
}

/// Rounds in turns, short ones: what else the machine does hits both sides of most of them alike.
constexpr int kRounds = 200;

/// Seconds of each round.
struct Rounds {
  std::vector<double> bare;
  std::vector<double> ours;
};

void tell(const Rounds& rounds, int reads) {
  const auto best = [&](const std::vector<double>& all) {
    return *std::min_element(all.begin(), all.end()) * 1e6 / reads;
  };
  std::vector<double> ratios;
  for (std::size_t i = 0; i < rounds.bare.size(); ++i)
    ratios.push_back(100 * rounds.bare[i] / rounds.ours[i]);
  std::sort(ratios.begin(), ratios.end());
  std::printf("CoE reads, %d rounds of %d: best bare loop %.2f us, best session %.2f us: %.0f %%; ", kRounds,
              reads, best(rounds.bare), best(rounds.ours), 100 * best(rounds.bare) / best(rounds.ours));
  std::printf("ratio of a round %.0f %% (median), %.0f to %.0f %% (half of them)\n",
              ratios[ratios.size() / 2], ratios[ratios.size() / 4], ratios[ratios.size() * 3 / 4]);
}

int run(const std::string& url, int reads) {
  const auto child = ::fork();
  if (child == 0) serve(url);
  Result<std::unique_ptr<ethernet::Port>> port = fail(Errc::bus, "not yet");
  for (int i = 0; i < 200 && !port; ++i) {
    ::usleep(10'000);
    port = session::open_port(url, {});
  }
  if (!port) return std::fprintf(stderr, "%s\n", port.error().message.c_str()), 3;
  auto borrowed = std::make_unique<Borrowed>(**port);
  auto& noted = borrowed->cycles;
  session::Session session(std::make_unique<session::EtherCatNetwork>(std::move(borrowed), url), url, {});
  Rounds rounds;
  for (int round = 0; round < kRounds; ++round) {
    const auto begin = session.now();
    for (int i = 0; i < reads / kRounds; ++i)
      if (const auto value = session.upload(1, {0x6041, 0}); !value)
        return std::fprintf(stderr, "%s\n", value.error().message.c_str()), 3;
    rounds.ours.push_back(std::chrono::duration<double>(session.now() - begin).count());
    rounds.bare.push_back(bare_loop(**port, reads / kRounds));
  }
  tell(rounds, reads / kRounds);

  auto rules = drive::load_profile("sv2", kFolders);
  if (!rules) return 3;
  session.ethercat()->learn(1, rules->rules.coe);
  if (const auto up = session.network().request_state(1, session::NodeState::operational); !up)
    return std::fprintf(stderr, "%s\n", up.error().message.c_str()), 3;
  noted.clear();
  noted.reserve(4000);
  if (!session.wait([] { return false; }, session.now() + std::chrono::seconds(10))) return 3;
  std::vector<double> late;
  for (std::size_t i = 1; i < noted.size(); ++i)
    late.push_back(
        std::abs(std::chrono::duration<double, std::micro>(noted[i] - noted[i - 1]).count() - 4000));
  std::sort(late.begin(), late.end());
  std::printf("%zu intervals of 4 ms: off by p50 %.0f, p99 %.0f, p99.9 %.0f, at most %.0f us\n", late.size(),
              late[late.size() / 2], late[late.size() * 99 / 100], late[late.size() * 999 / 1000],
              late.back());
  if (!session.network().request_state(1, session::NodeState::pre_operational)) return 3;
  for (const auto& notice : session.network().take_notices()) std::printf("%s\n", notice.c_str());
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  return 0;
}

}  // namespace
}  // namespace servoctl::bench

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  return servoctl::bench::run(argv[1], std::atoi(argv[2]));
}
