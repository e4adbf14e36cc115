#include "ethernet/process.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <filesystem>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"

namespace servoctl::ethernet {
namespace {

constexpr std::size_t kCommandWidth = 60;

/// Its command line; empty where that cannot be read.
std::string command_of(::pid_t process) {
  constexpr std::uintmax_t kMostBytes = 64U << 10U;
  auto words = read_file(formatted("/proc/{}/cmdline", process), kMostBytes).value_or("");
  std::replace(words.begin(), words.end(), '\0', ' ');
  const auto line = trim(words);
  const auto program = line.substr(0, line.find(' '));
  const auto name = std::filesystem::path(program).filename().string();
  return clip(name + std::string(line.substr(program.size())), kCommandWidth);
}

}  // namespace

::pid_t peer_process(int socket) {
  ucred peer{};
  socklen_t size = sizeof peer;
  return ::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 ? peer.pid : 0;
}

std::string process_words(::pid_t process) {
  if (process <= 0) return "another process";
  const auto command = command_of(process);
  return command.empty() ? formatted("process {}", process) : formatted("process {} ({})", process, command);
}

}  // namespace servoctl::ethernet
