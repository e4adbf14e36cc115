// Clients of a gateway that come when there is no room left, on a socket of this machine.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "session/serve_gateway.hpp"
#include "sim/cell.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

can::Descriptor connect_to(const std::string& path) {
  can::Descriptor out(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  std::memcpy(at.sun_path, path.c_str(), path.size() + 1);
  EXPECT_EQ(::connect(out.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
  return out;
}

std::string ask(const can::Descriptor& client, std::string_view line) {
  EXPECT_EQ(::send(client.get(), line.data(), line.size(), MSG_NOSIGNAL), static_cast<ssize_t>(line.size()));
  std::string out(200, ' ');
  const auto size = ::recv(client.get(), out.data(), out.size(), 0);
  out.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  return out;
}

TEST(GatewayRoom, SixteenIdleClientsKeepNobodyOut) {
  const auto path = testing::TempDir() + "gateway-room-" + std::to_string(::getpid());
  gateway::Address address;
  address.path = path;
  auto listener = gateway::Listener::open(address);
  ASSERT_TRUE(listener) << listener.error().message.text();
  const std::vector<std::filesystem::path> folders{std::filesystem::path(source_dir()) / "eds"};
  auto bus = sim::open_sim("gsd600@1", folders, sim::SimBus::Clock::real_time);
  ASSERT_TRUE(bus);
  std::atomic<bool> over{false};
  Options options;
  options.cancelled = [&] { return over.load(); };
  Session session(std::move(*bus), "test", options);
  GatewayServer server(session, {});
  std::thread serving([&] { (void)serve_gateway(session, **listener, server); });
  std::vector<can::Descriptor> idle;
  for (std::size_t i = 0; i < gateway::Listener::kMostClients; ++i) idle.push_back(connect_to(path));
  const auto newcomer = connect_to(path);
  EXPECT_EQ(ask(newcomer, "[1] 1 r 0x1000 0 u32\r\n").substr(0, 4), "[1] ");
  over = true;
  serving.join();
}

}  // namespace
}  // namespace servoctl::session
