#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "ethercat/ring.hpp"
#include "ethernet/port.hpp"

namespace servoctl::session {

/// Whatever lives on a wire and is served in every step of it: mailboxes, cyclic process data, looks at
/// states.
class EtherCatTenant {
 public:
  virtual ~EtherCatTenant() = default;
  /// Takes its answers from the ring and posts what is due.
  virtual void serve(ethercat::Ring& ring, TimePoint now) = 0;
  /// When serve() has something to do although nothing arrived.
  virtual TimePoint deadline() const = 0;
};

/// The pump of one EtherCAT ring: frames between its port and the datagrams under way. While somebody waits
/// for one answer here, everything else goes on: process data above all.
class EtherCatWire {
 public:
  /// What came back of one request.
  struct Reply {
    Bytes data;
    std::uint16_t working_counter = 0;
    bool lost = false;
    bool is_done = false;
    bool done() const { return is_done; }
  };

  /// `tenant` outlives it.
  EtherCatWire(std::unique_ptr<ethernet::Port> port, EtherCatTenant& tenant)
      : port_(std::move(port)), tenant_(&tenant), ring_(ethercat::Ring::Options{}) {}

  ethernet::Port& port() { return *port_; }
  const ethernet::Port& port() const { return *port_; }
  ethercat::Ring& ring() { return ring_; }
  const ethercat::Ring& ring() const { return ring_; }
  TimePoint now() const { return port_->now(); }
  /// When the last step took in a frame, or ended without.
  TimePoint stepped_at() const { return stepped_at_; }
  /// Asked in every wait of exchange() and ask(); may be empty.
  void set_cancelled(std::function<bool()> cancelled) { cancelled_ = std::move(cancelled); }

  /// Serves the tenant and sends what is to be sent. Errc::bus when the port does not take it.
  Result<void> flush(TimePoint now);
  /// Waits until `deadline` at most, and takes in one frame at most. True when one arrived.
  Result<bool> step(TimePoint deadline);
  /// When step() has something to do although nothing arrives.
  TimePoint next_event() const;

  /// Makes all requests at once, in as few frames as they fit into and in their order, and waits for all of
  /// them. Errc::bus, or Errc::interrupted.
  Result<std::vector<Reply>> exchange(const std::vector<ethercat::Request>& requests);
  /// Waits for one arrival, or a while; Errc::bus, or Errc::interrupted.
  Result<void> go_on(TimePoint deadline);
  /// Runs one machine of ethercat/ to its end: its result.
  template <class Machine>
  auto ask(Machine& machine) -> typename decltype(machine.take_result())::value_type {
    Lease lease{&ring_, {}};
    for (;;) {
      if constexpr (requires { machine.on_time(now()); }) machine.on_time(now());
      while (lease.carrier.serve(machine, ring_, now())) {
      }
      if (auto result = machine.take_result()) return std::move(*result);
      auto until = kNever;
      if constexpr (requires { machine.deadline(); }) until = machine.deadline();
      if (const auto went = go_on(until); !went) return fail(went.error());
    }
  }

 private:
  struct Lease {
    ethercat::Ring* ring;
    ethercat::Carrier carrier;
    ~Lease();
  };

  void settle(TimePoint now);
  Result<void> send_frames(TimePoint now);

  std::unique_ptr<ethernet::Port> port_;
  EtherCatTenant* tenant_;
  ethercat::Ring ring_;
  std::function<bool()> cancelled_;
  TimePoint stepped_at_{};
};

}  // namespace servoctl::session
