#pragma once

#include <poll.h>

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "can/descriptor.hpp"
#include "gateway/address.hpp"

namespace servoctl::gateway {

/// The side that is asked: connections, each known by a number that no other ever gets.
class Listener {
 public:
  /// One more is taken in, so that who listens decides which of them goes.
  static constexpr std::size_t kMostClients = 16;

  struct Arrival {
    int who = 0;
    std::string bytes;
    bool came = false;   ///< A new one; it has said nothing yet.
    bool ended = false;  ///< Nothing more comes from it; it may still read.
    bool lost = false;   ///< It is gone.
  };

  /// Listens at an address of this machine. Errc::bus when it is taken, or there is no right to it. A socket
  /// file that nobody listens at any more is replaced.
  static Result<std::unique_ptr<Listener>> open(const Address& address);

  Listener(can::Descriptor socket, std::string path) : socket_(std::move(socket)), path_(std::move(path)) {}
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener();

  /// Begins to listen at what its socket is bound to; errno says why it cannot.
  bool start();

  /// What is to be waited for: the listener first, then each client with what `events` says of it (POLLIN,
  /// POLLOUT).
  std::vector<pollfd> interests(const std::function<short(int who)>& events) const;
  /// What came of it: `polled` are those of the last call of interests().
  std::vector<Arrival> take(std::span<const pollfd> polled);
  /// Takes off `text` what could be sent now. False when the client is gone.
  bool send(int who, std::string& text);
  void drop(int who) { clients_.erase(who); }
  std::size_t clients() const { return clients_.size(); }

 private:
  void accept_one(std::vector<Arrival>& out);
  Arrival read_from(int who, const can::Descriptor& client, short happened) const;

  can::Descriptor socket_;
  std::string path_;
  std::map<int, can::Descriptor> clients_;
  int last_ = 0;
};

}  // namespace servoctl::gateway
