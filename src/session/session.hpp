#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "base/time.hpp"
#include "canopen/transfer.hpp"
#include "session/exchange.hpp"
#include "session/known_identities.hpp"
#include "session/network.hpp"
#include "session/protection.hpp"

namespace servoctl::can {
class Bus;
}  // namespace servoctl::can
namespace servoctl::drive {
struct Profile;
}  // namespace servoctl::drive

namespace servoctl::session {

class Interleave;
class Stretch;

/// One SDO transfer: a read, or a write when `data` is set.
struct SdoRequest {
  std::uint8_t node = 0;
  ObjectAddress object;
  std::optional<Bytes> data = {};
  canopen::Transfer transfer = canopen::Transfer::automatic;
  std::size_t size = 0;        ///< Bytes the object has, when known; for answers that do not say it.
  TimePoint* ended = nullptr;  ///< Where to note when its answer came, or when it was given up; may be null.
  bool despite_alarm = false;  ///< Sent although the drive may raise an alarm for it (access_alarm()).
};

struct Options {
  Duration timeout = std::chrono::milliseconds(500);  ///< Longest wait for one SDO answer.
  std::uint32_t retries = 1;        ///< Further tries of a read that was not answered; never of a write.
  std::function<bool()> cancelled;  ///< Asked in every wait; may be empty.
  /// Every wait ends then (Errc::interrupted), and no request begins from then on; one that is under way has
  /// 20 ms more. So what ends at a time does not wait for an answer first.
  TimePoint until = kNever;
  /// How many signals have come that end what goes on: exit paths, which are not cancelled, go on faster
  /// after each. May be empty.
  std::function<unsigned()> signals;
  /// Told, a line at a time, what a way out does while the bus is lost; may be empty.
  std::function<void(std::string_view line)> tell;
  /// Asked in every wait: serves the other networks of this process that cannot wait, and answers how long
  /// they have time then; may be empty.
  std::function<Duration()> beside;
  /// What tells this process from others that start at the same time: see claim_producer().
  std::uint64_t claim_seed = 0;
  /// Held while a drive is energised: a signal must not end the process at once then. May be null.
  Protection* protection = nullptr;
  /// Told how many bytes of a long transfer have gone, of how many in all where that is known, on the bus's
  /// clock; may be empty.
  std::function<void(std::size_t done, std::optional<std::size_t> total, TimePoint now)> progress;
  /// Called with the number of requests done in a long list, and the total; may be empty.
  std::function<void(std::size_t done, std::size_t total, TimePoint now)> list_progress;
  /// Told in every wait, ten times a second at most, what takes its time, or null where nobody said; may be
  /// empty.
  std::function<void(const Stretch* stretch, TimePoint now)> waiting;
  /// The folders with the families, some of which raise access alarms (consider_numbers()); may be empty.
  std::function<std::span<const std::filesystem::path>()> drive_folders = {};
  /// Before the first request that could raise an access alarm, 1000h and 1018h decide whether the node is
  /// such a drive (consider_before()), whatever family the user named.
  bool checks_numbers = false;
  /// Told of every transfer that was tried, whatever carried it; may be empty.
  std::function<void(const Exchange&)> exchanged;
  /// As Network::set_ordered(), of this session; may be empty.
  std::function<void(const Session&, std::uint8_t node, std::string_view order)> ordered;
};

/// A network with its nodes. One pump drives any number of transfers; who listens hears everything in every
/// wait. Knows nodes, objects and states; what only CAN has is behind can().
class Session {
 public:
  Session(std::unique_ptr<Network> network, std::string url, Options options);
  /// On a CAN bus.
  Session(std::unique_ptr<can::Bus> bus, std::string url, Options options);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Runs all requests: those of one node one after the other, those of different nodes at the same time. The
  /// answers stand in the order of the requests. After a node has not answered, or has refused a write, its
  /// further writes are not sent; after it has not answered, its further reads neither: a dead node costs one
  /// timeout (and its retries).
  std::vector<Result<Bytes>> transfer(std::span<const SdoRequest> requests);
  Result<Bytes> upload(std::uint8_t node, ObjectAddress object);
  Result<void> download(std::uint8_t node, ObjectAddress object, Bytes data);

  /// Listens until `done` answers true or the deadline passes; the answer is that of `done`.
  Result<bool> wait(const std::function<bool()>& done, TimePoint deadline);
  /// Takes in one arrival, or lets the deadline pass; true when something arrived. Errc::interrupted when
  /// cancelled, else as Network::step().
  Result<bool> step(TimePoint deadline);
  /// The same, for who waits beside others (Interleave): an arrival ends it only where `concerns` says that
  /// it is about the caller. It is asked by who steps, and steps nothing itself.
  Result<bool> step(TimePoint deadline, const std::function<bool()>& concerns);
  /// When what step() took in last arrived.
  TimePoint received_at() const { return received_at_; }
  /// Network::close(): the last call before it is destroyed, made by who opened it.
  Result<void> close() { return network_->close(); }
  /// Takes in whatever has arrived, without waiting.
  Result<void> listen();

  /// What nodes sent since the last call.
  std::vector<NodeEvent> take_events();
  /// What was heard of the nodes.
  const NodeRecords& watch() const { return network_->records(); }
  /// What nodes said they are, as long as they have not restarted.
  KnownIdentities& identities() { return identities_; }
  /// Drives that were left energised through this session and not seen without power since.
  EnergisedNodes& energised() { return energised_; }
  /// What Options::protection says, for as long as the answer lives.
  Protection::Hold protect(Care care) { return {options_.protection, care}; }
  /// From now on the node is not asked for objects that the data of this family lack, because each such
  /// request raises an alarm on its drives; null: it is asked for everything.
  void be_wary(std::uint8_t node, std::shared_ptr<const drive::Profile> profile);
  /// The same, because the drive's own numbers decided it, and not the user.
  void be_wary(const Identity& numbers, std::shared_ptr<const drive::Profile> profile);
  /// Null where there is none.
  const drive::Profile* wary_of(std::uint8_t node) const { return wary_[node & 0x7FU].profile.get(); }
  /// Whether its numbers decided since its last boot-up, and since it was silent last: later another drive
  /// may be there.
  bool is_considered(std::uint8_t node) const { return wary_[node & 0x7FU].boots == watch().boots(node); }
  /// 1000h as the node said it when its numbers decided; empty where that may be another drive by now.
  std::optional<std::uint32_t> device_type(std::uint8_t node) const {
    return is_considered(node) ? wary_[node & 0x7FU].device_type : std::nullopt;
  }
  /// The node was silent: another drive may be there, so its numbers decide again.
  void doubt_numbers(std::uint8_t node) { wary_[node & 0x7FU].boots.reset(); }
  /// Objects that a drive of no known family takes for an alarm, as far as they were looked for.
  std::set<ObjectAddress>& harmless() { return harmless_; }
  /// Values written to the flash of a node since the bus was opened, where each write wears it.
  std::size_t& flash_writes(std::uint8_t node) { return flash_writes_[node]; }

  TimePoint now() const { return network_->now(); }
  /// Since then everything is heard.
  TimePoint opened_at() const { return opened_at_; }
  Network& network() { return *network_; }
  const Network& network() const { return *network_; }
  /// What only CAN has: frames, NMT, SYNC, heartbeats and guarding. Null where there are no COB-IDs; commands
  /// that cannot do without say so in the registry.
  CanNetwork* can() { return network_->can(); }
  /// What only EtherCAT has; null elsewhere.
  EtherCatNetwork* ethercat() { return network_->ethercat(); }
  /// What only Modbus has; null elsewhere.
  ModbusNetwork* modbus() { return network_->modbus(); }
  /// What only a gateway of CiA 309-3 has; null elsewhere.
  GatewayNetwork* gateway() { return network_->gateway(); }
  const std::string& url() const { return url_; }
  Options& options() { return options_; }
  /// What takes its time now, the innermost last; kept by Stretch itself.
  std::vector<const Stretch*>& stretches() { return stretches_; }

  /// The bus was lost, and came back while something waited for it (BusReturn): who was there before may be
  /// another now, and nothing that was learned of the nodes holds for the next line.
  void note_away() { was_away_ = true; }
  bool was_away() const { return was_away_; }
  /// Whether a transfer or a wait ended with the loss of the bus since this was asked last, so that something
  /// may be missing.
  bool take_met_loss() { return std::exchange(met_loss_, false); }

  /// When listen() has something to do although nothing arrives from outside.
  TimePoint next_event() const { return network_->next_event(); }

  /// A channel to the objects of the node, for one run of transfers: kept from the last one where there was
  /// one.
  std::unique_ptr<ObjectChannel> lend_channel(std::uint8_t node);
  /// Keeps it for the next run, unless a transfer is under way.
  void give_back(std::uint8_t node, std::unique_ptr<ObjectChannel> channel);

 private:
  friend class Interleave;
  Result<bool> step_network(TimePoint deadline);
  void tell_waiting();

  std::unique_ptr<Network> network_;
  Interleave* interleave_ = nullptr;  ///< Whose jobs run on it now; null: none.
  TimePoint opened_at_;
  std::string url_;
  Options options_;
  KnownIdentities identities_;
  std::array<std::size_t, 128> flash_writes_{};
  EnergisedNodes energised_;
  struct Wary {
    std::shared_ptr<const drive::Profile> profile;
    /// Boot count of the node when its numbers decided; empty: they did not.
    std::optional<std::uint32_t> boots = {};
    std::optional<std::uint32_t> device_type = {};
  };
  std::array<Wary, 128> wary_;
  std::set<ObjectAddress> harmless_;
  std::array<std::unique_ptr<ObjectChannel>, 128> channels_;  ///< Those nobody uses now.
  TimePoint received_at_{};
  std::vector<const Stretch*> stretches_;
  TimePoint told_waiting_{};
  bool was_away_ = false;
  bool met_loss_ = false;
};

}  // namespace servoctl::session
