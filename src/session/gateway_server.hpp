#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "gateway/answer.hpp"
#include "gateway/request.hpp"
#include "session/gateway_client.hpp"
#include "session/identity.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// A gateway of CiA 309-3 (ASCII mapping) on the network of a session: bytes of clients go in, answers come
/// out. The requests of one client are carried out one after the other, those of several at the same time
/// where they concern different nodes. No I/O but on the network.
///
/// What raises an alarm on a drive that does not have the object (refusal_of()) is answered without the
/// drive.
///
/// A drive that a client enabled by its controlword, or by what `Options::energises` knows, is that client's:
/// when it goes, `Options::stop` is called for it, and nothing else is begun meanwhile.
class GatewayServer {
 public:
  struct Options {
    bool writes = false;  ///< Else a write and an NMT command are refused with 102.
    std::string version;  ///< Of this program, for `info version`: `0.1`.
    /// A line for who looks on; may be empty.
    std::function<void(std::string_view line)> tell = {};
    /// Whether a write energises a drive, or sets it in motion, besides by 6040h; may be empty. Asked once
    /// for each write, before it is sent.
    std::function<bool(std::uint8_t node, ObjectAddress object, ByteSpan data)> energises = {};
    /// Takes the power of these drives, and returns when that is done or told; may be empty.
    std::function<void(const std::set<std::uint8_t>& nodes)> stop = {};
  };
  /// A client with more answers that it has not read waits for its next one.
  static constexpr std::size_t kMostOutput = 65'536;

  GatewayServer(Session& session, Options options) : session_(&session), options_(std::move(options)) {}
  GatewayServer(const GatewayServer&) = delete;
  GatewayServer& operator=(const GatewayServer&) = delete;

  void on_client(int who) { clients_[who]; }
  void on_bytes(int who, std::string_view bytes);
  /// Nothing more comes from it; what it asked for is answered.
  void on_end(int who);
  /// It is gone. What it asked for and was not begun is not done.
  void on_lost(int who);

  /// Begins what can be begun, and answers what has ended. To be called whenever something came in, from a
  /// client or the network, and at deadline(). Errc::bus when the network is lost.
  Result<void> serve();
  /// When serve() has something to do although nothing comes in: at once where lines are left.
  TimePoint deadline() const;

  /// Whether its next bytes should be taken in: not while lines of it wait.
  bool wants_more(int who) const;
  /// What is to be sent to it; who sends takes it off.
  std::string& output(int who) { return clients_[who].out; }
  /// It ended, and has all its answers.
  bool is_done(int who) const;
  /// Whether nothing is lost when it goes: it waits for no answer, and enabled no drive.
  bool may_go(int who) const;
  /// The drives that clients enabled.
  std::set<std::uint8_t> energised() const;

 private:
  using Client = GatewayClient;
  struct Lane {
    std::unique_ptr<ObjectChannel> channel;
    int who = 0;
    TimePoint begun{};
    /// What decides whether the drive may be asked for every object, read before the first request of a
    /// client: empty while the request itself is under way.
    std::optional<Identity> numbers = {};
    std::size_t numbers_read = 0;
  };

  void take_lines(Client& client);
  void handle(Client& client, const gateway::LineReader::Line& line);
  void answer(Client& client, std::uint32_t sequence, const gateway::Request& request);
  void refuse(Client& client, std::uint32_t sequence, const gateway::Request& request);
  std::string set_default(Client& client, std::uint32_t sequence, const gateway::Request& request);
  std::string command(Client& client, std::uint32_t sequence, const gateway::Request& request);
  std::string begin_transfer(Client& client, std::uint32_t sequence, const gateway::Request& request);
  Result<void> send_command(gateway::Service service, std::uint8_t node);
  void start_orders();
  void start(int who, Client& client);
  bool begin(Lane& lane, Client::Order& order);
  void ask_number(Lane& lane);
  bool take_number(Lane& lane, const Result<Bytes>& result);
  Result<void> serve_lane(std::uint8_t node, Lane& lane);
  void tell(std::uint8_t node, const Lane& lane, const Result<Bytes>& result) const;
  void finish(const Lane& lane, const Result<Bytes>& result);
  /// Whether there was one.
  bool stop_abandoned();
  void cut(std::uint8_t node);
  bool may_take_lines(const Client& client) const;
  void tell(std::string_view line) const {
    if (options_.tell) options_.tell(line);
  }

  Session* session_;
  Options options_;
  std::map<int, Client> clients_;
  std::map<std::uint8_t, Lane> lanes_;     ///< Of nodes with a transfer under way.
  std::map<std::uint8_t, int> energised_;  ///< Which client enabled the drive.
  int served_last_ = 0;                    ///< Whose transfer began last: the next is another's turn.
};

}  // namespace servoctl::session
