// What `monitor` costs at full load where no emulator is in the way: the real command on a SocketCAN bus
// whose socket is one end of a pair; a second process sends at the pace of the wire. usage:
// servoctl_monitor_bench [SECONDS]
#include <fcntl.h>
#include <linux/can.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include "can/socketcan.hpp"
#include "command/command.hpp"
#include "command/registry.hpp"

namespace servoctl::bench {
namespace {

const std::filesystem::path kFolders[] = {std::filesystem::path(SERVOCTL_SOURCE_DIR) / "eds"};

/// Frames of this size back to back at 1 Mbit/s, a millisecond of them at a time as an adapter hands them on.
[[noreturn]] void send_frames(int fd, std::uint8_t size, int per_second) {
  using Clock = std::chrono::steady_clock;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const auto begin = Clock::now();
  for (std::int64_t sent = 0;;) {
    const auto due = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin).count() *
                     per_second / 1000;
    for (; sent < due; ++sent) {
      can_frame frame{};
      frame.can_id = static_cast<canid_t>(0x181 + sent % 4);
      frame.can_dlc = size;
      frame.data[0] = static_cast<std::uint8_t>(sent);
      if (::send(fd, &frame, sizeof frame, 0) < 0) ::_exit(0);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

double cpu_seconds() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](timeval time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) / 1e6;
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

struct Load {
  const char* name;
  std::uint8_t size;
  int per_second;
};

/// One run of a command that listens; `records` as `-o jsonl`.
void measure(const Load& load, const char* what, bool records, const std::string& seconds) {
  int ends[2];
  const int bytes = 4 << 20;
  if (::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0, ends) != 0) std::exit(3);
  ::setsockopt(ends[1], SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  const auto sender = ::fork();
  if (sender == 0) send_frames(ends[1], load.size, load.per_second);
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  session::Session session(std::make_unique<can::SocketCanBus>(can::Descriptor(ends[0]), "can0"), "can0", {});
  const auto profile = drive::load_profile("gsd600", kFolders).value();
  const int out = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  command::Context context;
  context.session = &session;
  context.profile = &profile;
  context.wants_records = records;
  context.write = [&](std::string_view lines) {
    if (::write(out, lines.data(), lines.size()) < 0) std::exit(7);
  };
  command::Arguments arguments;
  arguments.add("--for", seconds + "s");
  arguments.add("--bitrate", "1M");
  const auto before = cpu_seconds();
  const auto result = command::find_command("monitor")->run(context, arguments);
  const auto used = cpu_seconds() - before;
  ::kill(sender, SIGKILL);
  if (!result) std::exit(3);
  const auto frames = std::get<std::uint64_t>(report::find(*result, "frames")->data());
  std::printf("%-28s %-18s %9llu %10.2f %12.2f\n", load.name, what, static_cast<unsigned long long>(frames),
              100 * used / std::atof(seconds.c_str()), used * 1e6 / static_cast<double>(frames));
}

}  // namespace
}  // namespace servoctl::bench

int main(int argc, char** argv) {
  using namespace servoctl::bench;
  const std::string seconds = argc > 1 ? argv[1] : "10";
  // 111 and 47 bits a frame with the gap between frames, no stuff bits.
  constexpr Load kLoads[] = {{"8 bytes, 9000 frames/s", 8, 9000}, {"0 bytes, 21,200 frames/s", 0, 21'200}};
  std::printf("full load of 1 Mbit/s        command               frames  %% of a core  us per frame\n");
  for (const auto& load : kLoads) {
    measure(load, "monitor", false, seconds);
    measure(load, "monitor -o jsonl", true, seconds);
  }
  return 0;
}
