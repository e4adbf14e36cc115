#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "can/bus.hpp"
#include "can/controller_report.hpp"
#include "canopen/duplicate_watch.hpp"
#include "canopen/node_guard.hpp"
#include "canopen/node_watch.hpp"
#include "canopen/sdo_client.hpp"
#include "session/known_identities.hpp"
#include "session/protection.hpp"
#include "session/sync_production.hpp"

namespace servoctl::session {

/// One SDO transfer: a read, or a write when `data` is set.
struct SdoRequest {
  std::uint8_t node = 0;
  ObjectAddress object;
  std::optional<Bytes> data = {};
  canopen::Transfer transfer = canopen::Transfer::automatic;
  std::size_t size = 0;  ///< Bytes the object has, when known; for answers that do not say it.
};

struct Options {
  Duration timeout = std::chrono::milliseconds(500);  ///< Longest wait for one SDO answer.
  std::uint32_t retries = 1;        ///< Further tries of a read that was not answered; never of a write.
  std::function<bool()> cancelled;  ///< Asked in every wait; may be empty.
  /// Told every frame that is received, in every wait; may be empty. See Hearing.
  std::function<void(const can::Frame& frame, TimePoint time)> heard;
  /// Told, a line at a time, what a way out does while the bus is lost; may be empty.
  std::function<void(std::string_view line)> tell;
  /// What tells this process from others that start at the same time: see claim_producer().
  std::uint64_t claim_seed = 0;
  /// Held while a drive is energised: a signal must not end the process at once then. May be null.
  Protection* protection = nullptr;
  /// Told how many bytes of a long transfer have gone, of how many in all where that is known, on the bus's
  /// clock; may be empty.
  std::function<void(std::size_t done, std::optional<std::size_t> total, TimePoint now)> progress;
  /// Told how many requests of a long list are done, of how many in all; may be empty.
  std::function<void(std::size_t done, std::size_t total, TimePoint now)> list_progress;
};

/// A bus with its nodes. One pump drives any number of protocol machines; listeners see every frame in every
/// wait.
class Session {
 public:
  Session(std::unique_ptr<can::Bus> bus, std::string url, Options options);

  /// Runs all requests: those of one node one after the other, those of different nodes at the same time. The
  /// answers stand in the order of the requests. After a node has not answered, or has refused a write, its
  /// further writes are not sent; after it has not answered, its further reads neither: a dead node costs one
  /// timeout (and its retries).
  std::vector<Result<Bytes>> transfer(std::span<const SdoRequest> requests);
  Result<Bytes> upload(std::uint8_t node, ObjectAddress object);
  Result<void> download(std::uint8_t node, ObjectAddress object, Bytes data);

  /// Sends a frame that belongs to no machine.
  Result<void> send(const can::Frame& frame) {
    duplicates_.on_sent(frame, now());
    return bus_->send(frame);
  }

  /// Listens until `done` answers true or the deadline passes; the answer is that of `done`.
  Result<bool> wait(const std::function<bool()>& done, TimePoint deadline);
  /// Receives one frame or lets the deadline pass, for commands that look at every frame; the listeners see
  /// it first. Errc::interrupted when cancelled, Errc::bus when the controller reports bus-off: nothing will
  /// be answered then.
  Result<std::optional<can::Frame>> receive(TimePoint deadline);
  /// When the frame that receive() gave last arrived.
  TimePoint received_at() const { return received_at_; }
  /// Takes in whatever has arrived, without waiting.
  Result<void> listen();

  /// What nodes told since the last call.
  std::vector<canopen::NodeEvent> take_events();
  /// What the controller reported since the last call; the same report in succession is told once.
  std::vector<can::ControllerReport> take_reports() { return std::exchange(reports_, {}); }
  canopen::NodeWatch& watch() { return watch_; }
  /// Whether two nodes have one number.
  canopen::DuplicateWatch& duplicates() { return duplicates_; }
  /// What nodes said they are, as long as they have not restarted.
  KnownIdentities& identities() { return identities_; }
  /// Guards a node in every wait from now on; what is noticed is among the events.
  void guard(std::uint8_t node, canopen::GuardOptions options);
  void stop_guarding();

  /// Drives that were left energised through this session and not seen without power since.
  EnergisedNodes& energised() { return energised_; }
  /// What Options::protection says, for as long as the answer lives.
  Protection::Hold protect(Care care) { return {options_.protection, care}; }
  /// Values written to the flash of a node since the bus was opened, where each write wears it.
  std::size_t& flash_writes(std::uint8_t node) { return flash_writes_[node]; }

  /// servoctl as a heartbeat producer (CiA 301, 7.2.8.2.2.2), state operational: one message at once and one
  /// a period, in every wait from now on. `node` 1..127 is servoctl's own.
  void produce_heartbeat(std::uint8_t node, Duration period) {
    heartbeat_ = {node, period, TimePoint::min()};
  }
  void stop_heartbeat() { heartbeat_.reset(); }
  /// Under which node-ID servoctl produces heartbeats now; empty when it does not.
  std::optional<std::uint8_t> heartbeat_node() const {
    return heartbeat_ ? std::optional(heartbeat_->node) : std::nullopt;
  }

  /// servoctl as SYNC producer: the first one at once, in every wait from now on.
  void produce_sync(const canopen::SyncProducer::Options& options) {
    sync_ = SyncProduction{options, canopen::SyncProducer(options, now())};
  }
  void stop_sync() { sync_.reset(); }
  /// Null where SYNC is not produced.
  const SyncProduction* sync() const { return sync_ ? &*sync_ : nullptr; }

  TimePoint now() const { return bus_->now(); }
  /// Since then every frame is heard.
  TimePoint opened_at() const { return opened_at_; }
  can::Bus& bus() { return *bus_; }
  const std::string& url() const { return url_; }
  Options& options() { return options_; }

  /// When listen() has something to do although nothing arrives from outside.
  TimePoint next_event() const;

 private:
  friend class TransferRun;

  Result<void> on_report(can::ControllerReport report);
  /// Sends the heartbeat when it is due; the answer is when the next one is.
  Result<TimePoint> send_heartbeat();
  /// The same for SYNC.
  Result<TimePoint> send_sync();

  struct Heartbeat {
    std::uint8_t node;
    Duration period;
    TimePoint next;
  };

  std::unique_ptr<can::Bus> bus_;
  TimePoint opened_at_;
  std::string url_;
  Options options_;
  canopen::NodeWatch watch_;
  canopen::DuplicateWatch duplicates_;
  KnownIdentities identities_;
  canopen::NodeGuard guard_;
  std::optional<Heartbeat> heartbeat_;
  std::optional<SyncProduction> sync_;
  std::vector<can::ControllerReport> reports_;
  std::optional<can::ControllerReport> last_report_;
  std::array<std::size_t, 128> flash_writes_{};
  EnergisedNodes energised_;
  /// When the last frame arrived, or receive() ended without one; asking the clock costs a system call on
  /// some machines.
  TimePoint received_at_{};
};

}  // namespace servoctl::session
