#include "can/socketcand.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <thread>

#include "base/signal_wait.hpp"
#include "tests/can/late_opening.hpp"

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

Frame server_frame(const char* text) { return parse_frame(text).value(); }

/// A server on loopback that answers each element as scripted; for one connection after the other.
class ScriptedServer {
 public:
  using Script = std::function<std::string(const std::string& element)>;

  static std::string good(const std::string& element) {
    if (element == "< echo >") return element;
    return element.starts_with("< open ") || element == "< rawmode >" ? "< ok >" : "";
  }

  explicit ScriptedServer(Script script = good, std::string greeting = "< hi >")
      : script_(std::move(script)),
        greeting_(std::move(greeting)),
        listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(listener_.get(), generic, size), 0);
    EXPECT_EQ(::getsockname(listener_.get(), generic, &size), 0);
    EXPECT_EQ(::listen(listener_.get(), 4), 0);
    port_ = ntohs(address.sin_port);
    worker_ = std::thread([this] { work(); });
  }
  ~ScriptedServer() {
    ends_ = true;
    worker_.join();
  }

  std::string place() const { return "//127.0.0.1:" + std::to_string(port_) + "/can0"; }
  void hang_up() { hangs_up_ = true; }
  bool hears(const std::string& element) {
    for (int i = 0; i < 2000; ++i, nap(milliseconds(1))) {
      const std::lock_guard lock(mutex_);
      if (all_.find(element) != std::string::npos) return true;
    }
    return false;
  }
  /// Sent to whoever is connected.
  void send(const std::string& text) {
    const std::lock_guard lock(mutex_);
    pending_out_ += text;
  }

 private:
  void work() {
    while (!ends_) {
      pollfd entry{listener_.get(), POLLIN, 0};
      if (::poll(&entry, 1, 5) <= 0) continue;
      Descriptor client(::accept(listener_.get(), nullptr, nullptr));
      write_to(client, greeting_);
      hangs_up_ = false;
      serve(client);
    }
  }

  static void write_to(const Descriptor& client, const std::string& text) {
    (void)::send(client.get(), text.data(), text.size(), MSG_NOSIGNAL);
  }

  void serve(const Descriptor& client) {
    std::string pending;
    while (!ends_ && !hangs_up_) {
      {
        const std::lock_guard lock(mutex_);
        write_to(client, std::exchange(pending_out_, {}));
      }
      pollfd entry{client.get(), POLLIN, 0};
      if (::poll(&entry, 1, 2) <= 0) continue;
      char bytes[4096];
      const auto count = ::recv(client.get(), bytes, sizeof bytes, 0);
      if (count <= 0) return;
      pending.append(bytes, static_cast<std::size_t>(count));
      for (auto end = pending.find('>'); end != std::string::npos; end = pending.find('>')) {
        const auto element = pending.substr(0, end + 1);
        pending.erase(0, end + 1);
        const std::lock_guard lock(mutex_);
        all_ += element;
        write_to(client, script_(element));
      }
    }
  }

  std::mutex mutex_;
  Script script_;
  std::string greeting_;
  std::string all_;
  std::string pending_out_;
  Descriptor listener_;
  std::uint16_t port_ = 0;
  std::atomic<bool> ends_ = false;
  std::atomic<bool> hangs_up_ = false;
  std::thread worker_;
};

std::string server_refusal(const std::string& place) {
  const auto bus = open_socketcand(place);
  return bus ? "opened"
             : std::string(name(bus.error().code)) + ": " + bus.error().message.text() + "; " +
                   bus.error().hint.text();
}

TEST(Socketcand, OpensSendsAndReceives) {
  ScriptedServer server;
  const auto bus = open_socketcand(server.place());
  ASSERT_TRUE(bus) << bus.error().message.text();
  EXPECT_TRUE(server.hears("< open can0 >< rawmode >"));
  EXPECT_TRUE((*bus)->send(server_frame("601#4041600000000000")));
  EXPECT_TRUE(server.hears("< send 601 8 40 41 60 0 0 0 0 0 >"));
  server.send("< frame 581 1700000000.000001 4B41600050020000 >< frame 00000123 1700000000.000500  >");
  EXPECT_EQ((*bus)->receive((*bus)->now() + seconds(2)).value(), server_frame("581#4B41600050020000"));
  const auto first = (*bus)->arrived();
  EXPECT_EQ((*bus)->receive((*bus)->now() + seconds(2)).value(), server_frame("00000123#"));
  EXPECT_LE((*bus)->arrived() - first, milliseconds(1)) << "by the server's time stamps";
  EXPECT_EQ((*bus)->receive((*bus)->now()).value(), std::nullopt);
}

TEST(Socketcand, ARemoteFrameIsRefusedAndNothingIsSent) {
  ScriptedServer server;
  const auto bus = open_socketcand(server.place());
  ASSERT_TRUE(bus);
  const auto sent = (*bus)->send(server_frame("701#R"));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, Errc::usage);
  EXPECT_NE(sent.error().message.text().find("its protocol has none"), std::string::npos);
  EXPECT_TRUE((*bus)->send(server_frame("701#00")));
  EXPECT_TRUE(server.hears("< send 701 1 0 >"));
}

TEST(Socketcand, ABurstGoesThroughWithoutFillingTheServer) {
  std::atomic<int> frames = 0;
  ScriptedServer server([&](const std::string& element) {
    frames += element.starts_with("< send ");
    return ScriptedServer::good(element);
  });
  const auto bus = open_socketcand(server.place());
  ASSERT_TRUE(bus);
  for (int i = 0; i < 2000; ++i) ASSERT_TRUE((*bus)->send(server_frame("601#4041600000000000")));
  EXPECT_TRUE((*bus)->send(server_frame("7FF#")));
  EXPECT_TRUE(server.hears("< send 7FF 0 >"));
  EXPECT_EQ(frames, 2001);
}

TEST(Socketcand, AServerThatHangsIsToldWhenItIsFull) {
  ScriptedServer server([](const std::string& element) {
    static int echoes = 0;
    return element == "< echo >" && ++echoes > 1 ? "" : ScriptedServer::good(element);
  });
  const auto bus = open_socketcand(server.place());
  ASSERT_TRUE(bus);
  Result<void> sent;
  for (int i = 0; i < 2000 && sent; ++i) sent = (*bus)->send(server_frame("601#4041600000000000"));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, Errc::bus);
  EXPECT_NE(sent.error().message.text().find("takes no frames any more"), std::string::npos);
}

TEST(Socketcand, AConnectionThatIsClosedIsToldAtOnceAndOpenedAnew) {
  ScriptedServer server;
  const auto bus = open_socketcand(server.place());
  ASSERT_TRUE(bus);
  server.send("< frame 581 1700000000.000001 AA >");
  EXPECT_EQ((*bus)->receive((*bus)->now() + seconds(2)).value(), server_frame("581#AA"));
  server.hang_up();
  const auto begin = (*bus)->now();
  const auto lost = (*bus)->receive(begin + seconds(5));
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, Errc::bus);
  EXPECT_NE(lost.error().message.text().find("closed the connection"), std::string::npos);
  EXPECT_LT((*bus)->now() - begin, seconds(1));
  EXPECT_FALSE((*bus)->send(server_frame("601#00"))) << "until it is recovered";
  EXPECT_TRUE((*bus)->recover((*bus)->now() + seconds(2)));
  EXPECT_TRUE((*bus)->send(server_frame("602#00")));
  EXPECT_TRUE(server.hears("< send 602 1 0 >"));
}

TEST(Socketcand, AnOpeningThatTakesLongerThanARecoveryGoesOnWithTheNextOne) {
  std::atomic<int> opened = 0;
  ScriptedServer server([&](const std::string& element) {
    // Behind the loss the interface takes 300 ms.
    if (element.starts_with("< open ") && ++opened == 2) nap(milliseconds(300));
    return ScriptedServer::good(element);
  });
  const auto bus = open_socketcand(server.place());
  ASSERT_TRUE(bus);
  server.hang_up();
  ASSERT_FALSE((*bus)->receive((*bus)->now() + seconds(5)));
  EXPECT_GT(recoveries_until_open(**bus, server_frame("601#00")), 3);
  EXPECT_EQ(opened, 2);
}

TEST(Socketcand, WhatTheServerRefusesIsTold) {
  ScriptedServer server([](const std::string& element) {
    return element.starts_with("< open ") ? "< error could not open bus >" : ScriptedServer::good(element);
  });
  EXPECT_NE(server_refusal(server.place()).find("refuses can0: could not open bus"), std::string::npos);
}

TEST(Socketcand, WhatIsNoServerIsTold) {
  ScriptedServer other([](const std::string&) { return std::string(); }, "SSH-2.0-OpenSSH\r\n");
  EXPECT_NE(server_refusal(other.place()).find("is no socketcand"), std::string::npos);
  const auto nobody = [] {
    ScriptedServer gone;
    return gone.place();
  }();
  EXPECT_NE(server_refusal(nobody).find("bus: nothing listens at 127.0.0.1:"), std::string::npos);
  EXPECT_NE(
      server_refusal("//no-such-host.invalid/can0").find("bus: the host no-such-host.invalid is not found"),
      std::string::npos);
}

TEST(Socketcand, AServerThatSaysNothingIsGivenUp) {
  ScriptedServer server(ScriptedServer::good, "");
  SocketcandBus bus(parse_socketcand_place(server.place()).value());
  const auto opened = bus.open(bus.now() + milliseconds(100), false);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, Errc::bus);
  EXPECT_NE(opened.error().message.text().find("took the connection and does not answer"), std::string::npos);
}

TEST(Socketcand, ASignalEndsTheOpening) {
  ScriptedServer server(ScriptedServer::good, "");
  note_signal();
  const auto begin = steady_now();
  const auto bus = open_socketcand(server.place());
  ASSERT_FALSE(bus);
  EXPECT_EQ(bus.error().code, Errc::interrupted);
  EXPECT_LT(steady_now() - begin, seconds(1));
}

TEST(Socketcand, ElementsThatAreNoFrameAreLeftOutAndTold) {
  ScriptedServer server;
  const auto bus = open_socketcand(server.place());
  ASSERT_TRUE(bus);
  server.send("< frame 581 1700000000.000001 A >< error unknown command >< frame 581 1700000000.000001 AA >");
  EXPECT_EQ((*bus)->receive((*bus)->now() + seconds(2)).value(), server_frame("581#AA"));
  const auto notices = (*bus)->take_notices();
  ASSERT_EQ(notices.size(), 2U);
  EXPECT_NE(notices[0].text().find("reports an error: unknown command"), std::string::npos);
  EXPECT_NE(notices[1].text().find("1 element was left out"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::can
